#include "server/scene/plugins.h"

#include <algorithm>
#include <cmath>

#include "hwparts/kinds/part_kinds.h"
#include "hwparts/sensors/sensor_kinds.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;

constexpr double kUsualPeriod_ms = 10.0;

bool is_built_in(const std::string& kind) {
  const auto is = [&](const auto& row) { return kind == row.name; };
  return std::ranges::any_of(hwparts::part_kinds(), is) || std::ranges::any_of(sensors::sensor_kinds(), is);
}

// Refuses a plug-in with a kind that exists already: a name must have one meaning.
void refuse_taken_kinds(const Draft& draft, const plugin::Library& library, const Node& name) {
  const auto check = [&](const auto& kinds, const auto& find) {
    for (const auto& kind : kinds) {
      const std::string called = kind.name;
      if (is_built_in(called)) name.fail("brings a kind '" + called + "', but a built-in kind has that name");
      if (find(draft.scene.plugins, called))
        name.fail("brings a kind '" + called + "', but another plug-in has that name, too");
    }
  };
  check(library.manifest->agents, plugin::find_agent);
  check(library.manifest->sensors, plugin::find_sensor);
  check(library.manifest->parts, plugin::find_part);
  check(library.manifest->engines, plugin::find_engine);
}

std::int64_t read_period_ns(const Draft& draft, const Node& entry) {
  const auto tick_ns = draft.scene.world.tick_ns;
  const auto period = entry.find("period_ms");
  if (!period) return std::max(tick_ns, static_cast<std::int64_t>(kUsualPeriod_ms * 1e6));
  const std::int64_t period_ns = std::llround(period->number({0.0, 1e6, true}) * 1e6);
  if (period_ns < tick_ns) period->fail("must be at least a tick");
  return period_ns;
}

std::vector<std::string> kinds_of_agents(const Scene& scene) {
  std::vector<std::string> kinds;
  for (const auto& library : scene.plugins)
    for (const auto& kind : library.manifest->agents) kinds.emplace_back(kind.name);
  return kinds;
}

const plugin::AgentKind& kind_of(const Scene& scene, const Node& node) {
  if (const auto* kind = plugin::find_agent(scene.plugins, node.text())) return *kind;
  const auto known = kinds_of_agents(scene);
  if (known.empty()) node.fail("no plug-in of this scene has agents; name one under 'plugins'");
  node.one_of(known);
  throw std::logic_error("one_of takes what find_agent does not");
}

}  // namespace

void read_plugin(Draft& draft, const Node& node) {
  auto& plugins = draft.scene.plugins;
  const std::string name = node.text();
  if (draft.refuses_plugins)
    node.fail("plug-ins come only with the scene that a server starts with: start a server with this scene");
  if (std::ranges::any_of(plugins, [&](const auto& library) { return library.name == name; })) return;
  if (plugins.size() == plugin::kMaxLibraries)
    node.fail("more than " + std::to_string(plugin::kMaxLibraries) + " plug-ins");
  try {
    const auto library = plugin::open_library(name, draft.plugin_folders);
    refuse_taken_kinds(draft, library, node);
    plugins.push_back(library);
  } catch (const plugin::Error& error) {
    node.fail(error.what());
  }
}

void read_agent(Draft& draft, const Node& entry) {
  auto& agents = draft.scene.agents;
  if (agents.size() == kMaxAgents) entry.fail("more than " + std::to_string(kMaxAgents) + " agents");
  const std::string name = read_name(entry.get("name"));
  draft.claim("part", name, entry.place());
  const plugin::AgentKind& kind = kind_of(draft.scene, entry.get("kind"));
  agents.push_back({name, &kind, entry, 0, {}});
}

void find_parts_of_agents(Draft& draft) {
  std::vector<std::string> names;
  for (const PartPlan& plan : draft.scene.parts) names.push_back(plan.context.name);
  for (const SensorPlan& plan : draft.scene.sensors) names.push_back(plan.name);
  for (AgentPlan& agent : draft.scene.agents) {
    agent.period_ns = read_period_ns(draft, agent.config);
    const auto parts = agent.config.find("parts");
    if (!parts) continue;
    for (const std::string& word : parts->keys()) {
      const Node part = parts->get(word);
      part.one_of(names);
      const auto at = std::ranges::find(names, part.text());
      agent.parts.emplace_back(word, static_cast<std::size_t>(at - names.begin()));
    }
  }
}

}  // namespace visum::scene
