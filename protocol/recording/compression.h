// Chunks of recordings, compressed with zstd. The library stays inside compression.cc.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "protocol/recording/little_endian.h"

namespace visum::recording {

inline constexpr std::string_view kZstd = "zstd";  // its name in MCAP files

// Compresses a chunk piece by piece, as it grows, so that the end of a chunk is no more work than any other
// piece. The same pieces become the same bytes. Used on one thread at a time. Throws std::bad_alloc.
class Compressor {
 public:
  Compressor();
  ~Compressor();

  void add(Bytes piece);
  // Adds the last piece. Returns the chunk, until the next call, and begins another one.
  Bytes finish(Bytes piece);

 private:
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

// Any thread. Returns false if `packed` is not what a Compressor makes of `size` bytes. Allocates no memory
// where the packed bytes cannot hold so many, or say that they hold another number.
bool decompress(Bytes packed, std::size_t size, std::vector<std::byte>& to);

}  // namespace visum::recording
