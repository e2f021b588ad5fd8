// A model on a client's disk, as the files of a SpawnModel: the file itself and those that it names, such as
// meshes and drives. Any thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::protocol {

inline constexpr std::size_t kMostSentFiles = 256;                   // of one model
inline constexpr std::size_t kMostSentBytes = std::size_t{8} << 20;  // all of them together, with their paths
inline constexpr std::size_t kMostPathBytes = 256;

// Reads the file and, as deep as they go, the files whose names stand in it: relative to the file, or by
// package://NAME/ and model://NAME/ below a folder NAME above it. Files that it names otherwise are left to
// the server, which says what it misses. The paths are relative to the deepest folder that holds all. Throws
// std::runtime_error that names what cannot be read, or which limit is exceeded.
SpawnModel bundle_of_model(const std::filesystem::path& file);

}  // namespace visum::protocol
