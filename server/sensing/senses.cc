#include "server/sensing/senses.h"

#include <algorithm>

namespace visum::sensing {

Senses::Senses(const scene::Scene& scene, std::span<sensors::Sensor* const> sensors) : scene_(scene) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const auto& plan = scene.sensors.at(i);
    const Mount mount{plan.body, plan.X_BS, plan.joint};
    bound_.push_back({sensors[i], make_probe(plan.kind, {scene, mount, plan.config})});
    bound_.back().probe->attach(*sensors[i]);
  }
  if (std::ranges::any_of(bound_, [](const Bound& bound) { return bound.probe->wants_rays(); }))
    rays_ = std::make_unique<RayWorld>(scene.world);
}

void Senses::feel(const world::WorldState& before, const world::WorldState& now,
                  std::span<const collision::Contact> contacts, std::span<const dynamics::Wrench> pushes) {
  const Moment moment{scene_.world, before, now,
                      contacts,     pushes, static_cast<double>(scene_.world.tick_ns) * 1e-9,
                      rays_.get()};
  bool placed = false;
  for (Bound& bound : bound_) {
    if (!bound.sensor->due()) continue;
    if (bound.probe->wants_rays() && !placed) {
      rays_->place(now);
      placed = true;
    }
    bound.probe->measure(moment, bound.sensor->truth());
  }
}

}  // namespace visum::sensing
