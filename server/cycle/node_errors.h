// Finds all errors in the parts and sensors of a scene, by making each one alone. A Simulation would throw
// the first and hide the others, so `visumd check` asks here.
#pragma once

#include <vector>

#include "protocol/config/config.h"
#include "server/scene/scene.h"

namespace visum::cycle {

std::vector<config::ConfigError> errors_of_nodes(const scene::Scene& scene);

}  // namespace visum::cycle
