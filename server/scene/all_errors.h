// Finds all that is wrong with a scene, for `visum check`. load_scene() of scene.h stops at the first error.
#pragma once

#include <optional>
#include <vector>

#include "server/scene/scene.h"

namespace visum::scene {

// Returns the scene, or nothing and in `errors` every error that can be told apart. A wrong entry is left
// out. Later complaints that its name is missing are left out, too, because they follow from the first error.
std::optional<Scene> load_scene(const std::filesystem::path& file, const Options& options,
                                std::vector<config::ConfigError>& errors);

inline constexpr std::size_t kMaxErrors = 100;

}  // namespace visum::scene
