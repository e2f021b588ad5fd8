// `visum convert`: turns a scene from one encoding into another.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/scene/scene.h"

namespace visum::scene {

// Reads by the file's extension: .yaml, those of models, .x3d, .x3dv or .wrl. Throws ConfigError.
Scene read_any_scene(const std::filesystem::path& file, const Options& options);

// The scene that a program runs: as load_scene(), and from X3D and VRML97, too. Throws ConfigError.
Scene load_any(const std::filesystem::path& file, const Options& options);
// True for the extensions of X3D and VRML97.
bool is_x3d_file(const std::filesystem::path& file);

// Reads `from` and writes `to` (.yaml, .sdf, .x3d, .x3dv or .wrl). Returns what the encoding of `to` cannot
// hold, one sentence each. Throws ConfigError; `to` is then unchanged.
std::vector<std::string> convert(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const Options& options);

}  // namespace visum::scene
