#include "server/gateway/static_world.h"

namespace visum::gateway {

void StaticWorld::use(std::shared_ptr<const PartTable> other) {
  table = std::move(other);
  parts.clear();
  agents.clear();
  for (const auto& slot : table->slots) {
    parts.push_back(slot.part.get());
    agents.push_back(slot.agent);
  }
}

StaticWorld static_world(const cycle::Simulation& simulation) {
  const auto& scene = simulation.scene();
  StaticWorld world{scene.name,
                    scene.clock,
                    scene.world.tick_ns,
                    std::chrono::nanoseconds(scene.lockstep_timeout_ns),
                    {},
                    {},
                    std::make_shared<const WorldView>(describe_world(scene, simulation.revision()))};
  world.working = &simulation.working();
  world.use(PartNumbers(simulation).table());
  return world;
}

}  // namespace visum::gateway
