#include "clients/visum/common/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "protocol/config/printable.h"

namespace visum::cli {
namespace {

bool wants_colours(std::FILE* stream) {
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  if (no_color != nullptr && *no_color != '\0') return false;
  return is_terminal(stream) && term != nullptr && std::string(term) != "dumb";
}

}  // namespace

bool is_terminal(std::FILE* stream) {
  return ::isatty(::fileno(stream)) == 1;
}

std::size_t rows_of(std::FILE* stream) {
  winsize size{};
  return ::ioctl(::fileno(stream), TIOCGWINSZ, &size) == 0 ? size.ws_row : 0;
}

Style::Style(std::FILE* stream) : colours_(wants_colours(stream)) {}

std::string Style::wrap(const char* code, const std::string& text) const {
  if (!colours_) return text;
  return std::string("\033[") + code + "m" + text + "\033[0m";
}

std::string cut_to_rows(const std::string& text, std::size_t rows) {
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  if (rows < 2 || lines < rows) return text;
  const std::size_t kept = rows - 2;
  std::size_t end = 0;
  for (std::size_t line = 0; line < kept; ++line) end = text.find('\n', end) + 1;
  return text.substr(0, end) + "... " + std::to_string(lines - kept) + " more lines\n";
}

std::string printable(const std::string& text) {
  return config::printable(text, "\t");
}

}  // namespace visum::cli
