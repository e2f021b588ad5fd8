// `visumd convert`: a scene from one encoding into another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/scene/scene.h"

namespace visum::scene {

// By the ending of `file`: .yaml, .urdf, .sdf, .x3d, .x3dv or .wrl. Throws ConfigError at what is wrong.
Scene read_any_scene(const std::filesystem::path& file, const Options& options);

// Reads `from`, writes `to` (.yaml, .sdf, .x3d, .x3dv or .wrl) and returns what it could not hold, one
// sentence each. Throws ConfigError; `to` is then not touched.
std::vector<std::string> convert(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const Options& options);

}  // namespace visum::scene
