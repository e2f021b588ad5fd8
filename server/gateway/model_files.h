// Decides which models of the installation clients may spawn, and what they may send themselves.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/config/read_file.h"
#include "protocol/model_bundle.h"

namespace visum::gateway {

inline constexpr std::size_t kMostListed = 1000;  // of a folder

// The files of one kind in a folder and in those below it, as paths relative to it, sorted. Reads the folder;
// what cannot be read is left out.
std::vector<std::string> files_in(const std::filesystem::path& folder,
                                  bool (*is_one)(const std::filesystem::path& file));

// The models: robots' files, and files of the scene format with a parameter `name`.
std::vector<std::string> models_in(const std::filesystem::path& folder);

// The models that lie beside this program: installed (../share/visum/models), or in the source tree of a
// build folder. Empty: there are none.
std::filesystem::path find_models_folder();

// Why these files cannot be a model's; empty: they can.
std::string fault_of_files(const protocol::SpawnModel& request);
// The files by the paths at which the readers see them, below sent_folder(). They must be without a fault.
config::Files files_of(std::vector<protocol::ModelFile> sent);
std::filesystem::path sent_folder();

}  // namespace visum::gateway
