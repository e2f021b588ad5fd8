// Finds the mesh file that a model names.
#pragma once

#include <filesystem>
#include <string>

#include "protocol/config/config.h"
#include "server/scene/packages.h"

namespace visum::scene {

// Relative paths and file:// count from the model's file. package://NAME/REST and model://NAME/REST are
// searched as find_in_package() does. Throws ConfigError at `wanted_by` for other kinds of addresses, and if
// there is no such file.
std::filesystem::path resolve_mesh(const std::string& uri, const std::filesystem::path& model_file,
                                   const Packages& packages, const config::Place& wanted_by);

}  // namespace visum::scene
