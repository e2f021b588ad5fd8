#include "protocol/recording/compression.h"

#include <zstd.h>

namespace visum::recording {
namespace {

constexpr int kLevel = -1;  // level 1 saves 3 % more bytes in twice the time, level 3 another 2 % in 4 times

}  // namespace

bool compress(Bytes plain, std::vector<std::byte>& to) {
  to.resize(ZSTD_compressBound(plain.size()));
  const std::size_t size = ZSTD_compress(to.data(), to.size(), plain.data(), plain.size(), kLevel);
  if (ZSTD_isError(size) != 0 || size >= plain.size()) return false;
  to.resize(size);
  return true;
}

bool decompress(Bytes packed, std::size_t size, std::vector<std::byte>& to) {
  const auto told = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (told != ZSTD_CONTENTSIZE_UNKNOWN && told != size) return false;  // also where it is no frame of zstd
  to.resize(size);
  return ZSTD_decompress(to.data(), to.size(), packed.data(), packed.size()) == size;
}

}  // namespace visum::recording
