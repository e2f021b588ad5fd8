// CRC-32 as MCAP, zip and Ethernet use it (reflected polynomial 0xEDB88320), over bytes that arrive in
// pieces.
#pragma once

#include <array>
#include <cstdint>

#include "protocol/recording/little_endian.h"

namespace visum::recording {

// The CRC of each single byte, so that a byte needs one look-up instead of eight steps.
inline constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t entry = i;
    for (int bit = 0; bit < 8; ++bit) entry = (entry >> 1) ^ ((entry & 1) != 0 ? 0xEDB88320u : 0u);
    table[i] = entry;
  }
  return table;
}();

class Crc32 {
 public:
  void add(Bytes bytes) {
    for (const std::byte byte : bytes)
      state_ = kCrcTable[(state_ ^ std::to_integer<std::uint32_t>(byte)) & 0xFF] ^ (state_ >> 8);
  }
  std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFu;
};

inline std::uint32_t crc32(Bytes bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace visum::recording
