// `visumd check`: finds everything that a start would find wrong with a scene, without starting.
#pragma once

#include <filesystem>
#include <vector>

#include "server/scene/scene.h"

namespace visum::programs {

// Reads the scene, makes its parts and engines, and prints on stdout what is in it. Throws what a start would
// throw. Of several ConfigErrors it throws the last and logs the others. With `json` it also prints all of
// them on stdout, as one line.
void check_scene(const std::filesystem::path& file, const scene::Options& options, bool json);

// The same without printing: throws the first ConfigError.
void demand_right(const std::filesystem::path& file, const scene::Options& options);

// Prints the errors of a scene on stdout as one line of JSON: the first one's members at the top level, and
// all in the list `errors`. There must be at least one.
void print_wrong_as_json(const std::vector<config::ConfigError>& errors);

}  // namespace visum::programs
