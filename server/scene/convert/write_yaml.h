// Writes a scene as one YAML file without includes, parameters, frames and repetition. Every entry has its
// place in the world, every number all its digits.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/scene/convert/output.h"
#include "server/scene/scene.h"

namespace visum::scene {

// Name, gravity, time, engines and surfaces, as keys of a scene file with their values.
std::vector<std::pair<std::string, std::string>> settings_of(const Scene& scene);

std::string to_yaml(const Scene& scene, Output& output);

}  // namespace visum::scene
