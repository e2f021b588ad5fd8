#include "protocol/command_line/parse.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/TypeTools.hpp>
#include <cctype>
#include <cmath>
#include <iostream>
#include <vector>

#include "protocol/command_line/help.h"
#include "protocol/command_line/man_page.h"
#include "protocol/config/unknown_name.h"

namespace visum::command_line {
namespace {

// A word that no option takes, and the app that it was given to.
struct Extra {
  const CLI::App* app = nullptr;
  std::string word;
};

// -0.5 is a number; -5x is not an option of ours either, but reads like one.
bool looks_like_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && std::isdigit(static_cast<unsigned char>(word[1])) == 0;
}

// The innermost verb that was given comes first, because its words came last. An app with prefix_command()
// hands on all words that follow it, so for that app nothing is extra.
std::optional<Extra> find_extra(const CLI::App& app) {
  for (const CLI::App* verb : app.get_subcommands())
    if (auto extra = find_extra(*verb)) return extra;
  if (app.get_prefix_command()) return std::nullopt;
  auto words = app.remaining();
  std::erase(words, "--");  // ends the options, and is no word itself
  for (const auto& word : words)
    if (looks_like_option(word)) return Extra{&app, word};
  if (words.empty()) return std::nullopt;
  return Extra{&app, words.front()};
}

// With the options of the app's groups, which CLI11 keeps as apps without a name.
void collect_options(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options())
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* group : app.get_subcommands([](const CLI::App*) { return true; }))
    if (group->get_name().empty()) collect_options(*group, names);
}

std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    if (!verb->get_name().empty()) names.push_back(verb->get_name());
  return names;
}

std::string why_extra(const Extra& extra) {
  if (looks_like_option(extra.word)) {
    std::vector<std::string> known;
    collect_options(*extra.app, known);
    return config::unknown_name("option", extra.word.substr(0, extra.word.find('=')), known);
  }
  if (const auto verbs = verbs_of(*extra.app); !verbs.empty() && extra.app->get_subcommands().empty())
    return config::unknown_name("verb", extra.word, verbs);
  return "'" + extra.word + "' is one word too many";
}

// The app whose options the error is about: the verb that was given last.
const CLI::App& innermost(const CLI::App& app) {
  const auto verbs = app.get_subcommands();
  return verbs.empty() ? app : innermost(*verbs.back());
}

std::string refusal(const CLI::App& app, const std::string& why) {
  const std::string name = full_name(app);
  return name + ": " + why + "\n`" + name + " --help` shows what it takes.\n";
}

// `PROGRAM --help-man` and `visum VERB --help-man` print a manual page. That is for the build, so it is no
// option that --help shows.
const CLI::App* asked_for_page(const CLI::App& app, int argc, const char* const* argv) {
  const auto is_asked = [&](int i) { return argc == i + 1 && std::string_view(argv[i]) == "--help-man"; };
  if (is_asked(1)) return &app;
  if (!is_asked(2)) return nullptr;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    // A verb that hands all its words on has no help of its own, and the page is that of the other program.
    if (verb->get_name() == argv[1] && (!verb->get_prefix_command() || verb->get_help_ptr() != nullptr))
      return verb;
  return nullptr;
}

// A check for NaN and infinity, which no option means and which pass CLI::Range.
std::string check_finite(const std::string& word) {
  double number = 0.0;
  return !CLI::detail::lexical_cast(word, number) || std::isfinite(number)
             ? std::string()
             : "'" + word + "' is not a finite number";
}

void refuse_infinities(CLI::App& app) {
  for (CLI::Option* option : app.get_options())
    if (option->get_type_name().find("FLOAT") != std::string::npos) option->check(check_finite, "");
  for (CLI::App* inner : app.get_subcommands([](CLI::App*) { return true; })) refuse_infinities(*inner);
}

}  // namespace

void add_version(CLI::App& app) {
  app.set_version_flag("--version", app.get_name() + " " VISUM_VERSION);
}

std::string explain(const CLI::App& app, const CLI::Error& error) {
  // CLI11 reports a missing verb or argument before a word that it does not know. The unknown word is the
  // cause.
  if (const auto extra = find_extra(app)) return refusal(*extra->app, why_extra(*extra));
  const CLI::App& verb = innermost(app);
  if (error.get_name() == "RequiredError" && verb.get_subcommands().empty() && !verbs_of(verb).empty())
    return refusal(verb, "a verb is missing");
  return refusal(verb, error.what());
}

std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  use_wrapped_help(app);
  refuse_infinities(app);
  if (const CLI::App* one = asked_for_page(app, argc, argv)) {
    std::cout << man_page(*one);
    return 0;
  }
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << explain(app, error);
    return kBadUsage;
  }
}

std::string typed_name(const char* program, std::string_view verb, std::string_view otherwise) {
  return std::string_view(program) == "visum" ? "visum " + std::string(verb) : std::string(otherwise);
}

std::string full_name(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  return parent ? full_name(*parent) + " " + app.get_name() : app.get_name();
}

}  // namespace visum::command_line
