// Where the mesh that a model names lies on disk.
#pragma once

#include <filesystem>
#include <string>

#include "protocol/config/config.h"

namespace visum::scene {

// Relative paths and file:// start at the model's file; package://NAME/REST and model://NAME/REST are looked
// for beside the model and in the folders above it, as NAME/REST. Other addresses, and files that are not
// found, throw ConfigError at `wanted_by`.
std::filesystem::path resolve_mesh(const std::string& uri, const std::filesystem::path& model_file,
                                   const config::Place& wanted_by);

}  // namespace visum::scene
