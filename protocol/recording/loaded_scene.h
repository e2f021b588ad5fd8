// A scene that took the place of another one while the world ran, with everything that it was read from: the
// same world can be made again without a disk.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "protocol/config/read_file.h"

namespace visum::recording {

// Constant once made; shared by the world and its recorders. Its fields mean what those of a Header mean.
struct LoadedScene {
  std::string name;
  std::string file;  // absolute, one of `files`
  std::string engine, parameters;
  std::uint64_t seed = 0;
  std::vector<std::pair<std::string, std::string>> packages;
  std::vector<std::string> package_folders;
  config::Files files;
  bool operator==(const LoadedScene&) const = default;
};

}  // namespace visum::recording
