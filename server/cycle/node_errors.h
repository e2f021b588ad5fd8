// What is wrong with the parts and sensors of a scene, each made by itself; a Simulation throws the first.
#pragma once

#include <vector>

#include "protocol/config/config.h"
#include "server/scene/scene.h"

namespace visum::cycle {

std::vector<config::ConfigError> errors_of_nodes(const scene::Scene& scene);

}  // namespace visum::cycle
