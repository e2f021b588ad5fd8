#include "protocol/recording/crc32.h"

#include <libdeflate.h>

namespace visum::recording {

void Crc32::add(Bytes bytes) {
  if (bytes.empty()) return;  // for a null pointer the library begins anew
  value_ = ::libdeflate_crc32(value_, bytes.data(), bytes.size());
}

std::uint32_t crc32(Bytes bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace visum::recording
