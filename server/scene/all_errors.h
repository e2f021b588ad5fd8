// All that is wrong with a scene, for `visum check`; load_scene() ends at the first.
#pragma once

#include <optional>
#include <vector>

#include "server/scene/scene.h"

namespace visum::scene {

// The scene, or nothing and every error that can be told apart: an entry that is wrong is left out, and so
// are the complaints about its name that follow from that.
std::optional<Scene> load_scene(const std::filesystem::path& file, const Options& options,
                                std::vector<config::ConfigError>& errors);

inline constexpr std::size_t kMaxErrors = 100;

}  // namespace visum::scene
