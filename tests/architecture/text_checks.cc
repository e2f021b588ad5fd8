#include <algorithm>
#include <regex>

#include "tests/architecture/checks.h"
#include "tests/architecture/rules.h"

namespace visum::architecture {
namespace {

bool contains(std::span<const std::string> list, const std::string& value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

std::regex unfinished_pattern() {
  std::string words;
  for (const auto& word : unfinished_words()) words += (words.empty() ? "" : "|") + word;
  return std::regex("\\b(" + words + ")\\b");
}

}  // namespace

Findings check_finds_files(const SourceTree& tree) {
  Findings found;
  for (const std::string& folder : folders_with_code()) {
    const bool any = std::any_of(tree.files.begin(), tree.files.end(), [&](const auto& entry) {
      return is_cpp(entry.first) && starts_with_folder(entry.first, folder);
    });
    if (!any) found.push_back(folder + ": no C++ file found");
  }
  return found;
}

Findings check_top_level(const SourceTree& tree) {
  Findings found;
  for (const std::string& entry : tree.top_level)
    if (!contains(top_level_entries(), entry) && !contains(top_level_hidden_entries(), entry) &&
        !contains(untracked_entries(), entry))
      found.push_back(entry + ": the top level is fixed; see tests/architecture/rules.cc");
  return found;
}

Findings check_pragma_once(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files)
    if (is_header(path) && !contains(file.lines, "#pragma once"))
      found.push_back(path + ": has no #pragma once");
  return found;
}

Findings check_file_lengths(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files)
    if (is_code(path) && file.lines.size() > kMaxFileLines)
      found.push_back(path + ": " + std::to_string(file.lines.size()) + " lines, more than " +
                      std::to_string(kMaxFileLines));
  return found;
}

Findings check_function_lengths(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files) {
    if (!is_cpp(path)) continue;
    for (const FunctionSpan& span : find_functions(file))
      if (span.last_line - span.first_line + 1 > static_cast<int>(kMaxFunctionLines))
        found.push_back(path + ":" + std::to_string(span.first_line) + ": a function of more than " +
                        std::to_string(kMaxFunctionLines) + " lines");
  }
  return found;
}

Findings check_unfinished_words(const SourceTree& tree) {
  Findings found;
  const std::regex pattern = unfinished_pattern();
  for (const auto& [path, file] : tree.files)
    for (std::size_t i = 0; i < file.lines.size(); ++i)
      if (std::smatch match; std::regex_search(file.lines[i], match, pattern))
        found.push_back(path + ":" + std::to_string(i + 1) + ": " + match.str());
  return found;
}

Findings check_models_are_data(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files)
    if (starts_with_folder(path, "models") && is_code(path) && !is_model_generator(path))
      found.push_back(path + ": models/ holds data, and the make_*.py scripts that made it");
  return found;
}

}  // namespace visum::architecture
