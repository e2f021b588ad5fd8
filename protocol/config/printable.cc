#include "protocol/config/printable.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace visum::config {
namespace {

unsigned byte_at(std::string_view text, std::size_t at) {
  return at < text.size() ? static_cast<unsigned char>(text[at]) : 0;
}

// The character of a well-formed sequence.
std::uint32_t character_of(std::string_view sequence) {
  const unsigned first = byte_at(sequence, 0);
  std::uint32_t character = sequence.size() == 1 ? first : first & (0x7fu >> sequence.size());
  for (std::size_t i = 1; i < sequence.size(); ++i)
    character = character << 6 | (byte_at(sequence, i) & 0x3fu);
  return character;
}

bool is_printable(std::uint32_t c) {
  const bool control = c < 0x20 || (c >= 0x7f && c <= 0x9f);
  const bool separator = c == 0x2028 || c == 0x2029;
  const bool direction = c == 0x061c || c == 0x200e || c == 0x200f || (c >= 0x202a && c <= 0x202e) ||
                         (c >= 0x2066 && c <= 0x2069);
  return !control && !separator && !direction;
}

std::string escaped(const char* format, std::uint32_t value) {
  char text[8];
  std::snprintf(text, sizeof text, format, static_cast<unsigned>(value));
  return text;
}

}  // namespace

// Unicode 15, table 3-7.
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const unsigned first = byte_at(text, at), second = byte_at(text, at + 1);
  const auto continues = [&](std::size_t i) { return (byte_at(text, i) & 0xC0u) == 0x80u; };
  if (first < 0x80) return 1;
  if (first < 0xC2 || first > 0xF4 || !continues(at + 1)) return 0;
  if (first < 0xE0) return 2;
  if (!continues(at + 2)) return 0;
  if (first < 0xF0) {
    const bool overlong = first == 0xE0 && second < 0xA0, surrogate = first == 0xED && second >= 0xA0;
    return overlong || surrogate ? 0 : 3;
  }
  const bool overlong = first == 0xF0 && second < 0x90, beyond = first == 0xF4 && second >= 0x90;
  return overlong || beyond || !continues(at + 3) ? 0 : 4;
}

bool is_printable(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0 || !is_printable(character_of(text.substr(at, length)))) return false;
    at += length;
  }
  return true;
}

std::string printable(std::string_view text, std::string_view kept) {
  std::string shown;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = std::max<std::size_t>(utf8_length(text, at), 1);
    const auto sequence = text.substr(at, length);
    if (is_printable(sequence) || (length == 1 && kept.find(sequence) != kept.npos))
      shown += sequence;
    else if (length == 1)
      shown += escaped("\\x%02x", byte_at(sequence, 0));
    else
      shown += escaped("\\u%04x", character_of(sequence));
    at += length;
  }
  return shown;
}

std::string shortened(std::string text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0u) == 0x80u) --most;
  text.resize(most);
  return text;
}

}  // namespace visum::config
