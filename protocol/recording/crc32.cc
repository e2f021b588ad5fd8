#include "protocol/recording/crc32.h"

#include <zlib.h>

namespace visum::recording {

void Crc32::add(Bytes bytes) {
  if (bytes.empty()) return;  // for a null pointer zlib begins anew
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  value_ = static_cast<std::uint32_t>(::crc32_z(value_, data, bytes.size()));
}

std::uint32_t crc32(Bytes bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace visum::recording
