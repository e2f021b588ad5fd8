// `visumd convert`: writes a scene in another format.
#pragma once

#include <filesystem>

#include "server/scene/scene.h"

namespace visum::programs {

// Writes `to` and prints on stdout what that format could not hold. Returns true if nothing was lost. Throws
// ConfigError if the scene is wrong; with `json` it prints that error on stdout first, as one line.
bool convert_scene(const std::filesystem::path& from, const std::filesystem::path& to,
                   const scene::Options& options, bool json);

}  // namespace visum::programs
