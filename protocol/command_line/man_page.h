// A manual page for a program, made from the same options, texts and examples as its --help.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace visum::command_line {

// The page in roff, for section 1. Its name is the full name of the app with '-' for each blank: visum-run.
//
// The app's footer becomes several sections. Lines from "Example:" or "Examples:" on, as far as they are
// indented, are EXAMPLES. A line that begins with "Exit codes: " is EXIT STATUS. The rest is DESCRIPTION.
std::string man_page(const CLI::App& app);

}  // namespace visum::command_line
