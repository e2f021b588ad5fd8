#include "clients/visum/common/terminal.h"

#include <unistd.h>

#include <cstdlib>

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

Style::Style(std::FILE* stream) : colours_(wants_colours(stream)) {}

std::string Style::wrap(const char* code, const std::string& text) const {
  if (!colours_) return text;
  return std::string("\033[") + code + "m" + text + "\033[0m";
}

std::string printable(const std::string& text) {
  std::string clean;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    clean += (byte < 0x20 && c != '\t') || byte == 0x7f ? ' ' : c;
  }
  return clean;
}

}  // namespace visum::cli
