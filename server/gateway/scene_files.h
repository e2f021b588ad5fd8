// Finds the scenes of the installation. They lie beside its models, in the folder `scenes`. Clients give
// names, never paths.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace visum::gateway {

// Names, sorted: files below the folder, without the ending .yaml. The folder is read at each call.
std::vector<std::string> scenes_in(const std::filesystem::path& models);

// The file of one of scenes_in().
std::filesystem::path scene_file(const std::filesystem::path& models, const std::string& name);

}  // namespace visum::gateway
