#include "server/gateway/static_world.h"

namespace visum::gateway {

void StaticWorld::use(std::shared_ptr<const PartTable> other) {
  table = std::move(other);
  scene = table->scene;
  lockstep_timeout = table->lockstep_timeout;
  parts.clear();
  agents.clear();
  for (const auto& slot : table->slots) {
    parts.push_back(slot.part.get());
    agents.push_back(slot.agent);
  }
}

StaticWorld static_world(const cycle::Simulation& simulation) {
  const auto& scene = simulation.scene();
  StaticWorld world;
  world.clock = scene.clock;
  world.tick_ns = scene.world.tick_ns;
  world.view = std::make_shared<const WorldView>(describe_world(scene, simulation.revision()));
  world.working = &simulation.working();
  world.use(PartNumbers(simulation).table());
  return world;
}

}  // namespace visum::gateway
