// Help that fits a terminal of 80 columns.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace visum::command_line {

constexpr std::size_t kWidth = 80;  // columns of an ordinary terminal

// Breaks each line of `text` at blanks, so that it has at most `width` columns; further lines begin with
// `indent` blanks. A line that begins with a blank is an example and stays as it is. UTF-8: a character is a
// column.
std::string wrapped(std::string_view text, std::size_t indent = 0, std::size_t width = kWidth);

// Makes the app and its verbs print their help in that way.
void use_wrapped_help(CLI::App& app);

}  // namespace visum::command_line
