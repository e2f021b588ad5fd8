#include "server/scene/settings.h"

#include <algorithm>
#include <cmath>

#include "server/scene/values.h"

namespace visum::scene {
namespace {

constexpr double kNsPerMs = 1e6;
constexpr double kNsPerS = 1e9;
constexpr double kMaxTickMs = 1000.0;
constexpr double kMaxTimeoutS = 86400.0;
constexpr std::int64_t kMostWork = 1'000'000'000'000;
constexpr double kNsTolerance = 1e-6;  // decimal fractions of a millisecond are off by so much in binary

ClockKind read_clock(const config::Node& node) {
  return clock_of(node.one_of({kClockNames.begin(), kClockNames.end()}));
}

std::int64_t read_tick_ns(const config::Node& node) {
  const double ns = node.number({0.0, kMaxTickMs, true}) * kNsPerMs;
  if (ns < 1.0 || std::abs(ns - std::round(ns)) > kNsTolerance)
    node.fail("must be a whole number of nanoseconds, is " + node.text() + " ms");
  return std::llround(ns);
}

std::string kind_of_engine(const config::Node& node) {
  return read_name(node.kind() == config::Node::Kind::kScalar ? node : node.get("kind"));
}

int read_order(const config::Node& node) {
  const auto order = node.integer(2, 6);
  if (order % 2 != 0) node.fail("must be 2, 4 or 6, is " + node.text());
  return static_cast<int>(order);
}

std::uint64_t read_work_limit(const config::Node& node) {
  return static_cast<std::uint64_t>(node.integer(1, kMostWork));
}

// Reads "ode" or {kind: ode, step: quick, ...}. The engine table checks the settings of a kind; for a
// plug-in's kind, the plug-in does.
world::EngineSetting read_engine(const config::Node& node, bool plugged) {
  world::EngineSetting engine;
  engine.name = kind_of_engine(node);
  if (plugged || node.kind() == config::Node::Kind::kScalar) return engine;
  node.allow_only({engine_keys().begin(), engine_keys().end()});
  if (const auto step = node.find("step")) engine.step = step->one_of({"world", "quick"});
  if (const auto count = node.find("iterations"))
    engine.iterations = static_cast<int>(count->integer(1, 100'000));
  engine.erp = node.number_or("erp", engine.erp, {0.0, 1.0});
  engine.cfm = node.number_or("cfm", engine.cfm, {1e-9, 1e6});
  if (const auto solver = node.find("solver")) engine.solver = solver->one_of({"direct", "iterate"});
  if (const auto order = node.find("order")) engine.order = read_order(*order);
  engine.d_max = node.number_or("d_max", engine.d_max, {0.0, 1.0, true});
  engine.v_max = node.number_or("v_max", engine.v_max, {0.0, 1e6, true});
  if (const auto budget = node.find("budget")) engine.budget = static_cast<int>(budget->integer(1, 100'000));
  engine.sleep_s = node.number_or("sleep", engine.sleep_s, {0.0, 86400.0});
  if (const auto limit = node.find("work_limit")) engine.work_limit = read_work_limit(*limit);
  if (const auto impact = node.find("impact")) engine.impact = impact->one_of({"newton", "poisson"});
  return engine;
}

// Sets an engine that exists already.
void set_engine(Scene& scene, std::size_t number, const config::Node& node) {
  const bool plugged = plugin::find_engine(scene.plugins, kind_of_engine(node)) != nullptr;
  scene.world.engines[number] = read_engine(node, plugged);
  scene.engine_places[number] = node.place();
  scene.plugged_engines.erase(number);
  if (plugged && node.kind() == config::Node::Kind::kMap) scene.plugged_engines.emplace(number, node);
}

world::Surface read_surface(const std::string& name, const config::Node& node) {
  node.allow_only({"friction", "restitution", "rolling_friction", "torsional_friction"});
  world::Surface surface;
  surface.name = name;
  surface.friction = node.number_or("friction", surface.friction, {0.0, 1e6});
  surface.restitution = node.number_or("restitution", surface.restitution, {0.0, 1.0});
  surface.rolling_friction = node.number_or("rolling_friction", surface.rolling_friction, {0.0, 1e6});
  surface.torsional_friction = node.number_or("torsional_friction", surface.torsional_friction, {0.0, 1e6});
  return surface;
}

// `collision: fcl` is short for `collision: {stage: fcl}`.
void read_collision(const config::Node& node, world::WorldModel& world) {
  const auto read_stage = [&](const config::Node& name) {
    world.collision_stage =
        name.one_of({"visum", "fcl"}) == "fcl" ? world::CollisionKind::kFcl : world::CollisionKind::kVisum;
  };
  if (node.kind() == config::Node::Kind::kScalar) return read_stage(node);
  node.allow_only({"stage", "continuous", "work_limit"});
  if (const auto stage = node.find("stage")) read_stage(*stage);
  world.continuous_collision = node.boolean_or("continuous", world.continuous_collision);
  if (const auto limit = node.find("work_limit")) world.collision_work_limit = read_work_limit(*limit);
}

// True if an earlier include brought the same surface.
bool said_before(const std::vector<world::Surface>& surfaces, const world::Surface& again) {
  return std::any_of(surfaces.begin(), surfaces.end(), [&](const world::Surface& known) {
    return known.name == again.name && known.friction == again.friction &&
           known.restitution == again.restitution && known.rolling_friction == again.rolling_friction &&
           known.torsional_friction == again.torsional_friction;
  });
}

}  // namespace

std::span<const std::string_view> engine_keys() {
  static const std::vector<std::string_view> known{"kind",   "step",  "iterations", "erp",   "cfm",
                                                   "solver", "order", "d_max",      "v_max", "budget",
                                                   "impact", "sleep", "work_limit"};
  return known;
}

void read_settings(Draft& draft, const config::Node& root) {
  Scene& scene = draft.scene;
  if (const auto node = root.find("name")) scene.name = read_name(*node);
  if (const auto node = root.find("gravity")) scene.world.gravity = read_vector(*node);
  if (const auto node = root.find("tick_ms")) scene.world.tick_ns = read_tick_ns(*node);
  if (const auto node = root.find("collision")) read_collision(*node, scene.world);
  if (const auto node = root.find("clock")) scene.clock = read_clock(*node);
  if (const auto node = root.find("speed")) scene.speed = node->number({kLeastSpeed, kMostSpeed});
  if (const auto node = root.find("seed")) scene.seed = static_cast<std::uint64_t>(node->integer(0));
  if (const auto node = root.find("lockstep_timeout_s"))
    scene.lockstep_timeout_ns = std::llround(node->number({1e-3, kMaxTimeoutS}) * kNsPerS);
}

void read_engines(Draft& draft, const config::Node& root) {
  Scene& scene = draft.scene;
  if (const auto node = root.find("engine")) set_engine(scene, 0, *node);
  const auto engines = root.find("engines");
  if (!engines) return;
  for (const std::string& name : engines->keys()) {
    const config::Node node = engines->get(name);
    if (const std::string fault = name_fault(name); !fault.empty()) node.fail("an engine's name " + fault);
    if (name == kMainEngine) node.fail("this name stands for the scene's 'engine', choose another");
    draft.claim("engine", name, node.place());
    if (scene.world.engines.size() == kMaxEngines)
      node.fail("there are more than " + std::to_string(kMaxEngines) + " engines");
    scene.world.engines.emplace_back();
    scene.engine_names.push_back(name);
    scene.engine_places.push_back(node.place());
    set_engine(scene, scene.world.engines.size() - 1, node);
  }
}

void read_surfaces(Draft& draft, const config::Node& root) {
  const auto surfaces = root.find("surfaces");
  if (!surfaces) return;
  for (const std::string& name : surfaces->keys()) {
    const config::Node node = surfaces->get(name);
    if (const std::string fault = name_fault(name); !fault.empty()) node.fail("a surface's name " + fault);
    const world::Surface surface = read_surface(name, node);
    if (name == draft.scene.world.surfaces[0].name) {
      draft.scene.world.surfaces[0] = surface;  // a setting: the including file may set it again
      continue;
    }
    if (said_before(draft.scene.world.surfaces, surface)) continue;
    draft.claim("surface", name, node.place());
    if (draft.scene.world.surfaces.size() == kMaxSurfaces)
      node.fail("there are more than " + std::to_string(kMaxSurfaces) + " surfaces");
    draft.scene.world.surfaces.push_back(surface);
  }
}

}  // namespace visum::scene
