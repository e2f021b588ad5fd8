#include "clients/visum/run/placeholders.h"

#include <algorithm>
#include <string_view>

#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"

namespace visum::run {
namespace {

const std::vector<std::string> kKnown{"connect", "host", "port", "scenario_dir",
                                      "scene",   "bin",  "seed", "clock"};
constexpr std::string_view kBus = "bus.";

// Calls literal(text) and name(text) for the pieces of `text` in turn; returns what is wrong with it, if
// anything.
std::optional<std::string> split(const std::string& text, auto&& literal, auto&& name) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool doubled = i + 1 < text.size() && text[i + 1] == text[i];
    if (text[i] != '{' && text[i] != '}') {
      literal(text[i]);
    } else if (doubled) {
      literal(text[i++]);
    } else if (text[i] == '}') {
      return "a '}' without its '{' (write '}}' for the brace itself)";
    } else {
      const std::size_t end = text.find('}', i);
      if (end == std::string::npos) return "a '{' without its '}' (write '{{' for the brace itself)";
      name(text.substr(i + 1, end - i - 1));
      i = end;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> find_fault(const std::string& text) {
  std::optional<std::string> unknown;
  const auto check = [&](const std::string& name) {
    if (std::find(kKnown.begin(), kKnown.end(), name) != kKnown.end() || name.starts_with(kBus)) return;
    unknown = config::unknown_name("placeholder", name, kKnown);
  };
  const auto fault = split(
      text, [](char) {}, check);
  return fault ? fault : unknown;
}

std::vector<std::string> parts_with_bus(const std::string& text) {
  std::vector<std::string> parts;
  split(
      text, [](char) {},
      [&](const std::string& name) {
        if (name.starts_with(kBus)) parts.push_back(name.substr(kBus.size()));
      });
  return parts;
}

std::string fill_in(const std::string& text, const std::map<std::string, std::string>& values) {
  std::string filled;
  split(
      text, [&](char c) { filled += c; }, [&](const std::string& name) { filled += values.at(name); });
  return filled;
}

}  // namespace visum::run
