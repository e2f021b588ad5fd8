#include "clients/bridges/finroc/bytes.h"

#include <bit>

namespace visum::finroc {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

std::span<const std::byte> Reader::take_bytes(std::size_t count) {
  if (failed_ || count > bytes_.size() - position_) {
    failed_ = true;
    return {};
  }
  position_ += count;
  return bytes_.subspan(position_ - count, count);
}

std::string Reader::take_string() {
  std::string text;
  while (!failed_) {
    const char letter = take<char>();
    if (failed_ || letter == '\0') break;
    text += letter;
  }
  return failed_ ? std::string() : text;
}

Writer& Writer::put_string(std::string_view text) {
  for (const char letter : text) text_ += letter == '\0' ? '?' : letter;  // a 0 would end it
  text_ += '\0';
  return *this;
}

}  // namespace visum::finroc
