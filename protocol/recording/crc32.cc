#include "protocol/recording/crc32.h"

#include <zlib.h>

namespace visum::recording {

void Crc32::add(Bytes bytes) {
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  if (data)
    value_ = static_cast<std::uint32_t>(::crc32_z(value_, data, bytes.size()));  // null would ask for 0
}

std::uint32_t crc32(Bytes bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace visum::recording
