// A sensor whose kind comes from a plug-in. It fails as others do; where the plug-in's code throws, it is
// `off`, and the blackboard `fault` says why. Its truth is measured by server/sensing, which hands over the
// world.
#pragma once

#include <memory>

#include "hwparts/plugged/node_guard.h"
#include "hwparts/sensors/sensor.h"
#include "protocol/plugin/plugin.h"

namespace visum::plugged {

class PluggedSensor final : public sensors::Sensor {
 public:
  PluggedSensor(const sensors::SensorContext& context, sensors::Layout layout, bool wants_rays,
                std::unique_ptr<plugin::Sensor> node);

  bool wants_rays() const { return wants_rays_; }
  // Fills truth(); turns the sensor off where that fails.
  void measure(const plugin::Truth& world);

  std::span<const std::byte> read_blackboard(std::size_t) const override { return guard_.blackboard(); }
  const std::string* node_fault() const override { return &guard_.fault(); }

 protected:
  void shown_again(std::span<const double>) override { guard_.forgive(); }

 private:
  std::unique_ptr<plugin::Sensor> node_;
  NodeGuard guard_;
  const bool wants_rays_;
};

// Throws ConfigError at what is wrong in the sensor's entry.
std::unique_ptr<sensors::Sensor> make_sensor(const plugin::SensorKind& kind,
                                             const sensors::SensorContext& context);

}  // namespace visum::plugged
