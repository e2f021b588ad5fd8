// `visumd check`: everything that a start would find wrong with a scene, without a start.
#pragma once

#include <filesystem>

#include "server/scene/scene.h"

namespace visum::gateway {

// Reads the scene, makes its parts and its engines, and says on stdout what is in it. Throws what a start
// would throw; with `json`, the ConfigError stands on stdout, too, as one line.
void check_scene(const std::filesystem::path& file, const scene::Options& options, bool json);

}  // namespace visum::gateway
