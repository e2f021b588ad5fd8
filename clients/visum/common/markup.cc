#include "clients/visum/common/markup.h"

#include "clients/visum/common/utf8.h"

namespace visum::cli {

std::string markup(const std::string& text) {
  std::string escaped;
  for (const char c : valid_utf8(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\n':
        escaped += "&#10;";
        break;
      default: {
        const auto byte = static_cast<unsigned char>(c);
        escaped += (byte < 0x20 && c != '\t') || byte == 0x7f ? '?' : c;
      }
    }
  }
  return escaped;
}

}  // namespace visum::cli
