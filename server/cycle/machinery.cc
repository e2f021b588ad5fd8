#include "server/cycle/machinery.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

#include "server/cycle/work_texts.h"
#include "server/dynamics/kinds/engine_kinds.h"
#include "server/dynamics/plugged/plugged_engine.h"
#include "server/scene/settings.h"

namespace visum::cycle {
namespace {

std::unique_ptr<dynamics::Engine> make_engine_of(const scene::Scene& scene, std::size_t number) {
  const auto index = static_cast<std::int32_t>(number);
  const auto* plugged = plugin::find_engine(scene.plugins, scene.world.engines[number].name);
  if (!plugged) return dynamics::make_engine(scene.world, index);
  if (std::ranges::any_of(dynamics::engine_kinds(),
                          [&](const auto& kind) { return std::string_view(kind.name) == plugged->name; }))
    throw std::runtime_error("a plug-in brings an engine '" + std::string(plugged->name) +
                             "', which Visum has already");
  const auto entry = scene.plugged_engines.find(number);
  const auto keys = scene::engine_keys();
  return dynamics::make_plugged_engine(
      *plugged, scene.world, index,
      entry == scene.plugged_engines.end() ? config::load_text("{}", "the engine's settings") : entry->second,
      {keys.begin(), keys.end()});
}

// An engine that does not exist, or that cannot hold what the scene gives it, is reported at the place where
// the scene, or the option --engine, names the engine.
std::unique_ptr<dynamics::Engine> make_engine(const scene::Scene& scene, std::size_t number) {
  try {
    return make_engine_of(scene, number);
  } catch (const config::ConfigError& error) {
    if (scene.plugged_engines.contains(number) || scene.engine_places.empty()) throw;
    throw config::ConfigError(scene.engine_places.at(number), error.message());
  } catch (const std::runtime_error& error) {
    if (scene.engine_places.empty()) throw std::runtime_error(std::string("--engine: ") + error.what());
    throw config::ConfigError(scene.engine_places.at(number), error.what());
  }
}

}  // namespace

bool may_make_engines(const scene::Scene& scene) {
  return std::ranges::all_of(scene.world.engines, [&](const world::EngineSetting& engine) {
    return engine.name == "impulse" && !plugin::find_engine(scene.plugins, engine.name);
  });
}

std::vector<std::unique_ptr<dynamics::Engine>> make_engines(const scene::Scene& scene) {
  std::vector<std::unique_ptr<dynamics::Engine>> engines;
  for (std::size_t i = 0; i < scene.world.engines.size(); ++i) engines.push_back(make_engine(scene, i));
  return engines;
}

Machinery make_machinery(const scene::Scene& scene, std::span<sensors::Sensor* const> sensors,
                         collision::PreparedMeshes& meshes) {
  const auto& model = scene.world;
  Machinery made;
  made.collision = std::make_unique<collision::CollisionStage>(model, meshes);
  made.world_step = std::make_unique<dynamics::WorldStep>(model, *made.collision);
  made.senses = std::make_unique<sensing::Senses>(scene, sensors);
  made.ring = std::make_shared<FlightRing>(model.joints.size(), model.bodies.size());
  made.work_texts = std::make_shared<const std::vector<std::string>>(work_texts_of(model));
  made.drives.resize(model.joints.size());
  made.following_errors.resize(model.joints.size());
  made.contact_forces.resize(model.bodies.size());
  return made;
}

}  // namespace visum::cycle
