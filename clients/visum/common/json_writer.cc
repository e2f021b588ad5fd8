#include "clients/visum/common/json_writer.h"

#include <cmath>

#include "clients/visum/common/format.h"
#include "clients/visum/common/utf8.h"
#include "protocol/config/printable.h"

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
  text_ += '"';
  const std::string valid = valid_utf8(text);
  for (std::size_t at = 0, length = 0; at < valid.size(); at += length) {
    length = config::utf8_length(valid, at);
    const auto sequence = std::string_view(valid).substr(at, length);
    if (sequence == "\n") {
      text_ += "\\n";
    } else if (!config::is_printable(sequence)) {
      text_ += length == 1 ? "\\u00" + config::printable(sequence).substr(2) : config::printable(sequence);
    } else {
      if (sequence == "\"" || sequence == "\\") text_ += '\\';
      text_ += sequence;
    }
  }
  text_ += '"';
}

}  // namespace visum::cli
