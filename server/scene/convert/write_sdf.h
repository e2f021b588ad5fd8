// A scene as an SDF world, for Gazebo and its kin: every body a model of its own, but those that joints
// connect, which are one model together.
#pragma once

#include <string>

#include "server/scene/convert/output.h"
#include "server/scene/scene.h"

namespace visum::scene {

std::string to_sdf(const Scene& scene, Output& output);

}  // namespace visum::scene
