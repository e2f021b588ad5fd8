#include "server/cycle/bound_part.h"

#include <algorithm>
#include <limits>

#include "hwparts/plugged/plugged_part.h"
#include "hwparts/plugged/plugged_sensor.h"
#include "hwparts/sensors/camera.h"
#include "hwparts/sensors/sensor_kinds.h"
#include "server/cycle/node_errors.h"

namespace visum::cycle {
namespace {

std::unique_ptr<hwparts::Part> make_part(const scene::Scene& scene, const scene::PartPlan& plan,
                                         const PartMaker& make) {
  auto context = plan.context;
  context.seed = scene.seed;
  if (const auto* kind = plugin::find_part(scene.plugins, plan.kind))
    return plugged::make_part(*kind, context);
  return make(plan.kind, context);
}

std::unique_ptr<sensors::Sensor> make_sensor(const scene::Scene& scene, const scene::SensorPlan& plan) {
  const sensors::SensorContext context{plan.name, plan.config, scene.world.tick_ns, scene.seed};
  if (const auto* kind = plugin::find_sensor(scene.plugins, plan.kind))
    return plugged::make_sensor(*kind, context);
  return sensors::make_sensor(plan.kind, context);
}

}  // namespace

void BoundPart::hear(std::int64_t tick, std::size_t first, std::span<const double> values) {
  if (silent) return;
  if (!network.ideal()) return network.send(tick, first, values);
  take(first, values);
}

void BoundPart::take(std::size_t first, std::span<const double> values) {
  std::ranges::copy(values, controller_inputs.begin() + static_cast<std::ptrdiff_t>(first));
  part->latch(controller_inputs);
}

void BoundPart::deliver(std::int64_t until_tick) {
  if (network.ideal()) return;
  for (auto& delay_line = network.writes(); delay_line.due(until_tick); delay_line.pop())
    take(delay_line.first(), delay_line.front());
}

std::vector<double>& BoundPart::readings(std::vector<double>& lost) {
  auto& shown = network.ideal() ? sensor_outputs : network.readings();
  if (!silent) return shown;
  lost = shown;
  return lost;
}

void BoundPart::set_network(const NetworkModel::Quality& quality, std::uint64_t seed) {
  if (network.quality() == quality) return;
  if (!network.ideal()) {
    deliver(std::numeric_limits<std::int64_t>::max());
    sensor_outputs = network.readings();
  }
  network.begin(quality, seed, sensor_outputs, controller_inputs.size());
}

void PixelBudget::take(const sensors::Sensor& sensor, const scene::SensorPlan& plan) {
  if (const auto* camera = dynamic_cast<const sensors::Camera*>(&sensor)) pixels_ += camera->pixels();
  if (pixels_ > sensors::kMaxPixelsInAll)
    plan.config.get("size").fail("the cameras have more than " + std::to_string(sensors::kMaxPixelsInAll) +
                                 " pixels together");
}

void start_ports(BoundPart& bound) {
  const auto& description = bound.part->description();
  bound.controller_inputs.clear();
  for (const auto& port : description.controller_inputs) bound.controller_inputs.push_back(port.initial);
  bound.sensor_outputs.clear();
  for (const auto& port : description.sensor_outputs) bound.sensor_outputs.push_back(port.initial);
}

BoundPart make_bound_part(const scene::Scene& scene, const scene::PartPlan& plan, const PartMaker& make) {
  BoundPart bound;
  bound.part = make_part(scene, plan, make);
  for (std::size_t joint : bound.part->joints()) bound.joints.push_back(plan.joints.at(joint));
  bound.samples.resize(bound.joints.size());
  bound.drives.resize(bound.joints.size());
  bound.following_errors.resize(bound.joints.size());
  start_ports(bound);
  return bound;
}

BoundPart make_bound_sensor(const scene::Scene& scene, const scene::SensorPlan& plan) {
  BoundPart bound;
  bound.part = make_sensor(scene, plan);
  start_ports(bound);
  return bound;
}

sensors::Sensor* sensor_of(const BoundPart& bound) {
  return dynamic_cast<sensors::Sensor*>(bound.part.get());
}

std::vector<config::ConfigError> errors_of_nodes(const scene::Scene& scene) {
  std::vector<config::ConfigError> errors;
  const auto attempt = [&](const auto& make) {
    try {
      make();
    } catch (const config::ConfigError& error) {
      errors.push_back(error);
    }
  };
  for (const auto& plan : scene.parts) attempt([&] { make_part(scene, plan, hwparts::make_part); });
  PixelBudget budget;
  for (const auto& plan : scene.sensors) attempt([&] { budget.take(*make_sensor(scene, plan), plan); });
  return errors;
}

}  // namespace visum::cycle
