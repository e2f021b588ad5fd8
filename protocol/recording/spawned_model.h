// A model that was spawned while the world ran, with everything that it was read from: the same model can be
// made again without a disk.
#pragma once

#include <array>
#include <string>

#include "protocol/config/read_file.h"

namespace visum::recording {

// Constant once made; shared by the world, its recorders and the states that they keep.
struct SpawnedModel {
  std::string file;  // absolute, one of `files`
  std::string name;
  std::array<double, 7> pose{0, 0, 0, 1, 0, 0, 0};  // x y z qw qx qy qz of its origin, in W
  config::Files files;
  bool operator==(const SpawnedModel&) const = default;
};

}  // namespace visum::recording
