// A sensor whose kind comes from a plug-in. It fails as other sensors do. Where the plug-in's code throws,
// the sensor is `off`, and the blackboard `fault` says why. server/sensing calls measure() and hands over the
// world. The simulation owns the sensor; it lives on the tick's thread.
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
  // Fills truth(). Turns the sensor off where that fails.
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

// Throws ConfigError for an error in the sensor's entry.
std::unique_ptr<sensors::Sensor> make_sensor(const plugin::SensorKind& kind,
                                             const sensors::SensorContext& context);

}  // namespace visum::plugged
