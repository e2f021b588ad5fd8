// What may be done to a terminal: colours (never where NO_COLOR is set, or into a file) and a line that is
// updated.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace visum::cli {

bool is_terminal(std::FILE* stream);
std::size_t rows_of(std::FILE* stream);  // 0: it does not say

class Style {
 public:
  explicit Style(std::FILE* stream);
  explicit Style(bool colours) : colours_(colours) {}
  std::string bold(const std::string& text) const { return wrap("1", text); }
  std::string red(const std::string& text) const { return wrap("31", text); }
  std::string green(const std::string& text) const { return wrap("32", text); }
  std::string dim(const std::string& text) const { return wrap("2", text); }

 private:
  std::string wrap(const char* code, const std::string& text) const;
  bool colours_;
};

// As many lines as fit above the cursor's own; the last one says how many are left out.
std::string cut_to_rows(const std::string& text, std::size_t rows);

// Text from elsewhere (controllers, servers) without what could steer the terminal.
std::string printable(const std::string& text);

}  // namespace visum::cli
