// Feeds all sensors of a world: holds a probe for each, and lets it measure when the sensor is due. Lives on
// the tick's thread; the Simulation owns it, and makes a new one when bodies come or go.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "hwparts/sensors/sensor.h"
#include "server/scene/scene.h"
#include "server/sensing/probe.h"

namespace visum::sensing {

class Senses {
 public:
  // `sensors`: one for each of the scene's sensor plans, in their order. Keeps references to scene and
  // sensors. Does not change the sensors yet, so that a construction that throws (ConfigError) leaves the old
  // Senses in use.
  Senses(const scene::Scene& scene, std::span<sensors::Sensor* const> sensors);

  // Attaches the probes to their sensors, in place of others. Before the first feel().
  void attach();

  // Fills the truth of the sensors that are due. Comes after the engines' step and before the sensors'
  // publish().
  void feel(const world::WorldState& before, const world::WorldState& now,
            std::span<const collision::Contact> contacts, std::span<const dynamics::Wrench> pushes);

 private:
  struct Bound {
    sensors::Sensor* sensor;
    std::unique_ptr<Probe> probe;
  };

  const scene::Scene& scene_;
  std::vector<Bound> bound_;
  std::unique_ptr<RayWorld> rays_;  // null: no probe wants rays
};

}  // namespace visum::sensing
