#include "server/gateway/static_world.h"

namespace visum::gateway {

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
  for (const auto& bound : simulation.parts()) {
    world.parts.push_back(bound.part.get());
    world.agents.push_back(bound.agent);
  }
  return world;
}

}  // namespace visum::gateway
