#include <array>
#include <stdexcept>

#include "protocol/config/unknown_name.h"
#include "server/dynamics/engine.h"
#include "server/dynamics/engine_factories.h"
#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics {
namespace {

constexpr std::array kKinds{
    EngineKind{"impulse",
               "joints held by impulses that look ahead; order: 2, 4 or 6, impact: newton or poisson",
               make_impulse_engine},
    EngineKind{"ode", "Open Dynamics Engine; step: world (direct) or quick (iterative, for many bodies)",
               make_ode_engine},
};

std::vector<std::string> known_names() {
  std::vector<std::string> names;
  for (const EngineKind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

}  // namespace

std::span<const EngineKind> engine_kinds() {
  return kKinds;
}

std::unique_ptr<Engine> make_engine(const world::WorldModel& model, std::int32_t engine_index) {
  if (engine_index < 0 || static_cast<std::size_t>(engine_index) >= model.engines.size())
    throw std::runtime_error("there is no engine number " + std::to_string(engine_index));
  const std::string& name = model.engines[static_cast<std::size_t>(engine_index)].name;
  for (const EngineKind& kind : kKinds) {
    if (name == kind.name) return kind.make(model, engine_index);
  }
  throw std::runtime_error(config::unknown_name("engine", name, known_names()));
}

const char* processor_build() {
  return impulse::kernels().build;
}

}  // namespace visum::dynamics
