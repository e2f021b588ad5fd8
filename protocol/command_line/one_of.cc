#include "protocol/command_line/one_of.h"

#include <algorithm>

#include "protocol/config/unknown_name.h"

namespace visum::command_line {
namespace {

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

}  // namespace

CLI::Validator one_of(const std::vector<std::string>& choices) {
  return {[choices](std::string& word) {
            if (std::ranges::find(choices, word) != choices.end()) return std::string();
            return "must be one of " + joined(choices, ", ") + ", is '" + word + "'" +
                   config::did_you_mean(word, choices);
          },
          "{" + joined(choices, ",") + "}"};
}

}  // namespace visum::command_line
