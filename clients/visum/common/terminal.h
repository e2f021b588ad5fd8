// Output for a terminal: colours (never with NO_COLOR, nor into a file) and text that must fit it.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace visum::cli {

bool is_terminal(std::FILE* stream);
std::size_t rows_of(std::FILE* stream);  // 0: unknown

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

// The first lines of `text`, as many as fit above the cursor's line. The last one says how many are left out.
std::string cut_to_rows(const std::string& text, std::size_t rows);

// A line from a controller or a server, escaped so that it cannot steer the terminal. Tabs stay.
std::string printable(const std::string& text);

}  // namespace visum::cli
