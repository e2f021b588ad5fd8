// `visumd convert`: a scene into another format.
#pragma once

#include <filesystem>

#include "server/scene/scene.h"

namespace visum::programs {

// Writes `to` and says on stdout what it could not hold; true: nothing was lost. Throws ConfigError where the
// scene is wrong; with `json`, that stands on stdout, too, as one line.
bool convert_scene(const std::filesystem::path& from, const std::filesystem::path& to,
                   const scene::Options& options, bool json);

}  // namespace visum::programs
