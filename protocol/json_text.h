// Texts and numbers for the few lines of JSON that programs print for scripts, or send to the page.
#pragma once

#include <charconv>
#include <cstdio>
#include <string>
#include <string_view>

namespace visum::protocol {

// Quotes a text as JSON requires (RFC 8259, section 7).
inline std::string json_quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      out += escaped;
    } else {
      out += c;
    }
  }
  return out + '"';
}

// The fewest digits that give the same bits when they are read. JSON has no infinity and no NaN: quote it.
inline std::string exact_number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace visum::protocol
