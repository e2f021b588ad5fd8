// Chunks of recordings, compressed with zstd. Pure functions; any thread. The library stays inside
// compression.cc.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "protocol/recording/little_endian.h"

namespace visum::recording {

inline constexpr std::string_view kZstd = "zstd";  // its name in MCAP files

// Returns false, with anything in `to`, if the bytes would not become fewer.
bool compress(Bytes plain, std::vector<std::byte>& to);
// Returns false if `packed` is not what compress() makes of `size` bytes. Allocates no memory where the
// packed bytes themselves say that they hold another number.
bool decompress(Bytes packed, std::size_t size, std::vector<std::byte>& to);

}  // namespace visum::recording
