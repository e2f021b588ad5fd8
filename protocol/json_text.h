// Quotes a text as JSON requires (RFC 8259, section 7), for the few lines that programs print for scripts.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace visum::protocol {

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

}  // namespace visum::protocol
