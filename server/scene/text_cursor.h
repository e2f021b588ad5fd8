// Walks over the words of a text and counts its lines, for the mesh readers. Blanks separate words.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace visum::scene {

class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  int line() const { return line_; }

  // The next word of the text, over lines; empty at the end.
  std::string_view word() {
    while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n';
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

 private:
  static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

// Reads a whole word as a number; false if it is none. Accepts "nan" and "inf": the caller must check.
template <typename Number>
bool parse_number(std::string_view word, Number& number) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace visum::scene
