#include "clients/visum/common/markup.h"

#include "clients/visum/common/utf8.h"

namespace visum::cli {

namespace {

// U+FFFE and U+FFFF are well-formed, but no characters of XML 1.0 (section 2.2).
std::string without_non_characters(std::string text) {
  for (const char* none : {"\xEF\xBF\xBE", "\xEF\xBF\xBF"})
    for (auto at = text.find(none); at != std::string::npos; at = text.find(none, at))
      text.replace(at, 3, "?");
  return text;
}

}  // namespace

std::string markup(const std::string& text) {
  std::string escaped;
  for (const char c : without_non_characters(valid_utf8(text))) {
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
