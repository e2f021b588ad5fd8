// Writes a scene as an SDF world, for Gazebo and related programs. Each body becomes a model; bodies that
// joints connect become one model together.
#pragma once

#include <string>

#include "server/scene/convert/output.h"
#include "server/scene/scene.h"

namespace visum::scene {

std::string to_sdf(const Scene& scene, Output& output);

}  // namespace visum::scene
