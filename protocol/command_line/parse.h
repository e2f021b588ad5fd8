// How every program of Visum reads its command line. CLI11 parses; this adds what CLI11 lacks: suggestions
// for misspelt options and verbs, help that fits 80 columns, a manual page made from the same app, and a
// refusal of NaN and infinity. All calls belong to the main thread, before the program starts others.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace CLI {
class App;
class Error;
}  // namespace CLI

namespace visum::command_line {

constexpr int kBadUsage = 2;  // the exit code for options that are wrong

// Adds `--version`, which prints the app's name and the version of this build.
void add_version(CLI::App& app);

// Reads the words into what the app's options are bound to. Returns nothing where the program goes on.
// Otherwise the text is printed and the program ends with this exit code: 0 for --help, --version and
// --help-man, else kBadUsage. The app must have its name, as a user types it.
std::optional<int> parse(CLI::App& app, int argc, const char* const* argv);

// A message of two lines that says what is wrong, where, and what to do. `app` threw `error` when it parsed
// its words.
std::string explain(const CLI::App& app, const CLI::Error& error);

// The command as the user typed it: `visum VERB` hands some verbs to server programs, and then passes its own
// name as argv[0]. For argv[0] "visum" that is "visum VERB", else `otherwise`.
std::string typed_name(const char* program, std::string_view verb, std::string_view otherwise);

// "visum run": the names of the app's parents, then its own.
std::string full_name(const CLI::App& app);

}  // namespace visum::command_line
