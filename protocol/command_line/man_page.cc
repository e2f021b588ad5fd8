#include "protocol/command_line/man_page.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include "protocol/command_line/parse.h"

namespace visum::command_line {
namespace {

// Escapes text for roff. A plain '-' would become a hyphen that cannot be pasted, and a '.' or ''' at the
// beginning of a line would be a request.
std::string escaped(std::string_view text) {
  std::string roff;
  for (const char c : text) {
    const bool begins_line = roff.empty() || roff.back() == '\n';
    if (begins_line && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '-')
      roff += "\\-";
    else if (c == '\\')
      roff += "\\e";
    else
      roff += c;
  }
  return roff;
}

std::string bold(std::string_view text) {
  return "\\fB" + escaped(text) + "\\fR";
}

std::string italic(std::string_view text) {
  return "\\fI" + escaped(text) + "\\fR";
}

// In quotes, as an argument of a request.
std::string as_argument(std::string_view text) {
  return "\"" + escaped(text) + "\"";
}

std::string page_name(const CLI::App& app) {
  std::string name = full_name(app);
  std::ranges::replace(name, ' ', '-');
  return name;
}

std::vector<const CLI::App*> children_of(const CLI::App& app, bool groups) {
  auto all = app.get_subcommands([](const CLI::App*) { return true; });
  std::erase_if(all, [&](const CLI::App* one) { return one->get_name().empty() != groups; });
  return all;
}

// The parts of an app's footer.
struct Footer {
  std::vector<std::string> paragraphs, examples;
  std::string exit_codes;
};

Footer split(const std::string& text) {
  Footer footer;
  bool in_examples = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    if (line.starts_with("Example")) {
      in_examples = true;
    } else if (line.starts_with("Exit codes: ")) {
      footer.exit_codes = line.substr(line.find(' ', 5) + 1);
    } else if (!line.empty() && in_examples && line.front() == ' ') {
      footer.examples.push_back(line.substr(std::min<std::size_t>(line.find_first_not_of(' '), 2)));
    } else if (!line.empty()) {
      in_examples = false;
      footer.paragraphs.push_back(line);
    }
  }
  return footer;
}

// "FILE", for an option that takes a value; with the range or the choices that its check names.
std::string value_of(const CLI::Option& option) {
  return option.get_type_size() == 0 ? std::string() : option.get_type_name();
}

std::string describe_option(const CLI::Option& option) {
  std::string names;
  const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + bold(name); };
  if (option.nonpositional()) {
    for (const auto& name : option.get_snames()) add("-" + name);
    for (const auto& name : option.get_lnames()) add("--" + name);
    if (const auto value = value_of(option); !value.empty()) names += " " + italic(value);
  } else {
    names = italic(option.get_name(true));
  }
  std::string text = escaped(option.get_description());
  const auto note = [&](const std::string& more) { text += (text.empty() ? "" : ". ") + more; };
  if (option.get_required() && option.nonpositional()) note("Required");
  if (!option.get_default_str().empty()) note("Default: " + escaped(option.get_default_str()));
  if (!option.get_envname().empty()) note("Environment: " + bold(option.get_envname()));
  return ".TP\n" + names + "\n" + text + "\n";
}

std::string options_of(const CLI::App& app, bool positional) {
  std::string text;
  for (const CLI::Option* option : app.get_options())
    if (option->nonpositional() != positional) text += describe_option(*option);
  for (const CLI::App* group : children_of(app, true))
    if (const auto of_group = options_of(*group, positional); !of_group.empty())
      text += ".SS " + as_argument(group->get_group()) + "\n" + of_group;
  return text;
}

std::string synopsis(const CLI::App& app) {
  std::string text = bold(full_name(app)) + " [" + italic("OPTIONS") + "]";
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) continue;
    const std::string name =
        italic(option->get_name(true)) + (option->get_items_expected_max() > 1 ? " ..." : "");
    text += option->get_required() ? " " + name : " [" + name + "]";
  }
  if (!children_of(app, false).empty()) text += " " + italic("VERB") + " ...";
  return text;
}

std::string begin_small(std::string text) {
  const bool is_word = text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0;
  if (is_word) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string begin_large(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string section(const char* title, const std::string& text) {
  return text.empty() ? std::string() : std::string(".SH ") + title + "\n" + text;
}

std::string verbs(const CLI::App& app) {
  std::string text;
  for (const CLI::App* verb : children_of(app, false))
    text += ".TP\n" + bold(page_name(*verb)) + "(1)\n" + escaped(begin_large(verb->get_description())) + "\n";
  return text;
}

std::string examples(const std::vector<std::string>& lines) {
  if (lines.empty()) return {};
  std::string text = ".nf\n";
  for (const auto& line : lines) text += escaped(line) + "\n";
  return text + ".fi\n";
}

std::string see_also(const CLI::App& app) {
  const std::string own = page_name(app);
  std::string text;
  for (const char* page : {"visum", "visumd", "visum-run"})
    if (own != page) text += (text.empty() ? "" : ",\n") + bold(page) + "(1)";
  return text + "\n";
}

}  // namespace

std::string man_page(const CLI::App& app) {
  const std::string name = page_name(app), purpose = app.get_description();
  const Footer footer = split(app.get_footer());
  std::string title = name;
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return std::toupper(c); });
  std::string description = escaped(begin_large(purpose)) + ".\n";
  for (const auto& paragraph : footer.paragraphs) description += ".PP\n" + escaped(paragraph) + "\n";
  const std::string exit_codes = footer.exit_codes.empty() ? "" : escaped(footer.exit_codes) + "\n";
  return ".TH " + as_argument(title) + " 1 \"\" " + as_argument("Visum " VISUM_VERSION) + " " +
         as_argument("Visum") + "\n" +
         section("NAME", escaped(name) + " \\- " + escaped(begin_small(purpose)) + "\n") +
         section("SYNOPSIS", synopsis(app) + "\n") + section("DESCRIPTION", description) +
         section("ARGUMENTS", options_of(app, true)) + section("VERBS", verbs(app)) +
         section("OPTIONS", options_of(app, false)) + section("EXIT STATUS", exit_codes) +
         section("EXAMPLES", examples(footer.examples)) + section("SEE ALSO", see_also(app));
}

}  // namespace visum::command_line
