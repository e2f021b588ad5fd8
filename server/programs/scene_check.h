// `visumd check`: everything that a start would find wrong with a scene, without a start.
#pragma once

#include <filesystem>
#include <vector>

#include "server/scene/scene.h"

namespace visum::programs {

// Reads the scene, makes its parts and its engines, and says on stdout what is in it. Throws what a start
// would throw; of several ConfigErrors all but the last stand in the log, and with `json` all on stdout, too,
// as one line.
void check_scene(const std::filesystem::path& file, const scene::Options& options, bool json);

// One line of JSON on stdout: where a scene is wrong, and how; the first by itself, and all as `errors`.
void print_wrong_as_json(const std::vector<config::ConfigError>& errors);

}  // namespace visum::programs
