#include "clients/visum/common/json_writer.h"

#include <cmath>

#include "clients/visum/common/format.h"
#include "clients/visum/common/utf8.h"

namespace visum::cli {

JsonWriter& JsonWriter::key(std::string_view name) {
  if (comma_) text_ += ',';
  append_quoted(name);
  text_ += ':';
  comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view text) {
  if (comma_) text_ += ',';
  append_quoted(text);
  comma_ = true;
  return *this;
}

JsonWriter& JsonWriter::value(double number) {
  return raw(std::isfinite(number) ? exact(number) : "null");
}

JsonWriter& JsonWriter::open(char bracket) {
  if (comma_) text_ += ',';
  text_ += bracket;
  comma_ = false;
  return *this;
}

JsonWriter& JsonWriter::close(char bracket) {
  text_ += bracket;
  comma_ = true;
  return *this;
}

JsonWriter& JsonWriter::raw(std::string_view token) {
  if (comma_) text_ += ',';
  text_ += token;
  comma_ = true;
  return *this;
}

void JsonWriter::append_quoted(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  text_ += '"';
  for (const char c : valid_utf8(text)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      text_ += '\\';
      text_ += c;
    } else if (c == '\n') {
      text_ += "\\n";
    } else if (byte < 0x20) {
      text_ += "\\u00";
      text_ += kHex[byte >> 4];
      text_ += kHex[byte & 15];
    } else {
      text_ += c;
    }
  }
  text_ += '"';
}

}  // namespace visum::cli
