// CRC-32 as MCAP, zip and Ethernet use it (reflected polynomial 0xEDB88320), over bytes that arrive in
// pieces. libdeflate computes it, with the processor's own instructions.
#pragma once

#include <cstdint>

#include "protocol/recording/little_endian.h"

namespace visum::recording {

class Crc32 {
 public:
  void add(Bytes bytes);
  std::uint32_t value() const { return value_; }

 private:
  std::uint32_t value_ = 0;  // of no bytes
};

std::uint32_t crc32(Bytes bytes);

}  // namespace visum::recording
