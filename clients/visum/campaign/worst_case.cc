#include "clients/visum/campaign/worst_case.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "clients/visum/common/json_writer.h"
#include "protocol/config/flow.h"

namespace visum::campaign {
namespace {

std::string replaced(std::string text, std::string_view from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string quoted(const std::string& text) {
  cli::JsonWriter json;
  return json.value(text).text();
}

std::string absolute_text(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

}  // namespace

std::string scenario_at(const config::Node& root, const run::SweepPoint& point, const std::string& engine,
                        const std::string& comment) {
  constexpr std::array<std::string_view, 6> kOfTheCampaign{"sweep",  "sampling", "decide",
                                                           "search", "record",   "description"};
  config::ExpansionBudget budget;
  const config::Node whole = config::expanded(root, point.variables, budget);
  // Within the quotes, which every text with braces has, and past the placeholders' own rules.
  const auto path = std::filesystem::path(root.place().file).parent_path();
  std::string folder = quoted(absolute_text(path.empty() ? "." : path));
  folder = replaced(replaced(folder.substr(1, folder.size() - 2), "{", "{{"), "}", "}}");
  std::string text = "# " + comment + "\n";
  for (const auto& key : whole.keys()) {
    if (std::ranges::find(kOfTheCampaign, key) != kOfTheCampaign.end()) continue;
    if (key == "engine" && !engine.empty()) continue;
    const config::Node node = whole.get(key);
    std::string value = config::flow(node);
    if (key == "scene") value = quoted(absolute_text(node.folder() / node.text()));
    if (key == "controllers") value = replaced(value, "{scenario_dir}", folder);
    text += key + ": " + replaced(value, "${", "$${") + "\n";
  }
  if (!engine.empty()) text += "engine: " + quoted(engine) + "\n";
  return text;
}

}  // namespace visum::campaign
