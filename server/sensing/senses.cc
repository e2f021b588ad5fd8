#include "server/sensing/senses.h"

#include <algorithm>

#include "hwparts/plugged/plugged_sensor.h"
#include "server/sensing/probes.h"

namespace visum::sensing {
namespace {

std::unique_ptr<Probe> probe_for(const scene::Scene& scene, const scene::SensorPlan& plan, const Mount& mount,
                                 const sensors::Sensor& sensor) {
  if (const auto* plugged = dynamic_cast<const plugged::PluggedSensor*>(&sensor))
    return make_plugged_probe(mount, *plugged);
  return make_probe(plan.kind, {scene, mount, plan.config});
}

}  // namespace

Senses::Senses(const scene::Scene& scene, std::span<sensors::Sensor* const> sensors) : scene_(scene) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    const auto& plan = scene.sensors.at(i);
    const Mount mount{plan.body, plan.X_BS, plan.joint};
    bound_.push_back({sensors[i], probe_for(scene, plan, mount, *sensors[i])});
  }
  if (std::ranges::any_of(bound_, [](const Bound& bound) { return bound.probe->wants_rays(); }))
    rays_ = std::make_unique<RayWorld>(scene.world);
}

void Senses::attach() {
  for (Bound& bound : bound_) bound.probe->attach(*bound.sensor);
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
