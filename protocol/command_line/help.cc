#include "protocol/command_line/help.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <memory>

namespace visum::command_line {
namespace {

constexpr std::size_t kNameColumns = 28;

std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

// One paragraph, word by word.
std::string wrapped_line(std::string_view line, std::size_t indent, std::size_t width) {
  if (line.empty() || line.front() == ' ') return std::string(line);
  std::string text;
  std::size_t used = 0;  // columns of the last line
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    const auto word = line.substr(begin, end - begin);
    begin = end + 1;
    if (!text.empty() && used + 1 + columns(word) > width) {
      text += "\n" + std::string(indent, ' ');
      used = indent;
    } else if (!text.empty()) {
      text += ' ';
      ++used;
    }
    text += word;
    used += columns(word);
  }
  return text;
}

// CLI11's own help, but for lines that are too long.
class WrappedFormatter : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    return wrapped(CLI::Formatter::make_description(app));
  }
  std::string make_footer(const CLI::App* app) const override {
    return wrapped(CLI::Formatter::make_footer(app));
  }
  std::string make_subcommand(const CLI::App* verb) const override {
    return two_columns(verb->get_name(), verb->get_description());
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return two_columns(make_option_name(option, is_positional) + make_option_opts(option),
                       make_option_desc(option));
  }

 private:
  static std::string two_columns(const std::string& name, const std::string& text) {
    std::string left = "  " + name;
    if (text.empty()) return left + "\n";
    if (columns(left) + 2 > kNameColumns)
      left += "\n" + std::string(kNameColumns, ' ');
    else
      left.resize(left.size() + kNameColumns - columns(left), ' ');
    return left + indented(text) + "\n";
  }
  // Further lines stand below the first.
  static std::string indented(const std::string& text) {
    const std::string narrow = wrapped(text, 0, kWidth - kNameColumns);
    std::string result;
    for (const char c : narrow) {
      result += c;
      if (c == '\n') result.append(kNameColumns, ' ');
    }
    return result;
  }
};

}  // namespace

std::string wrapped(std::string_view text, std::size_t indent, std::size_t width) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    result += wrapped_line(text.substr(begin, end - begin), indent, width);
    if (end < text.size()) result += '\n';
    begin = end + 1;
  }
  return result;
}

void use_wrapped_help(CLI::App& app) {
  const auto formatter = std::make_shared<WrappedFormatter>();
  formatter->label("SUBCOMMAND", "VERB");
  app.formatter(formatter);
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) use_wrapped_help(*verb);
}

}  // namespace visum::command_line
