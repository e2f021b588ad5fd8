// Writes JSON into a string, on one line. Numbers are as short as they can be and still read back to the same
// bits; NaN and infinity become null.
//
//   JsonWriter json;
//   json.begin_object().member("port",
//   1500).key("parts").begin_array().value("arm").end_array().end_object(); puts(json.text().c_str());  //
//   {"port":1500,"parts":["arm"]}
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace visum::cli {

class JsonWriter {
 public:
  JsonWriter& begin_object() { return open('{'); }
  JsonWriter& end_object() { return close('}'); }
  JsonWriter& begin_array() { return open('['); }
  JsonWriter& end_array() { return close(']'); }
  JsonWriter& key(std::string_view name);

  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  JsonWriter& value(double number);
  JsonWriter& value(bool flag) { return raw(flag ? "true" : "false"); }
  template <std::integral T>
  JsonWriter& value(T number) {
    return raw(std::to_string(number));
  }
  JsonWriter& value(const std::vector<std::string>& texts) {
    begin_array();
    for (const auto& text : texts) value(text);
    return end_array();
  }
  JsonWriter& number(const std::string& digits) { return raw(digits); }  // already in JSON's form
  JsonWriter& null() { return raw("null"); }
  JsonWriter& new_line() {  // between two values, for readers with lines of bounded length
    text_ += '\n';
    return *this;
  }

  template <typename T>
  JsonWriter& member(std::string_view name, const T& content) {
    return key(name).value(content);
  }

  const std::string& text() const { return text_; }

 private:
  JsonWriter& open(char bracket);
  JsonWriter& close(char bracket);
  JsonWriter& raw(std::string_view token);
  void append_quoted(std::string_view text);

  std::string text_;
  bool comma_ = false;  // before the next value
};

}  // namespace visum::cli
