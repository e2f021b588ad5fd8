// All sensors of a world with what feeds them. Made anew when bodies come or go. Lives on the tick's thread.
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
  // One sensor for each of the scene's plans, in their order. Keeps references to both, and leaves the
  // sensors as they are. Throws ConfigError.
  Senses(const scene::Scene& scene, std::span<sensors::Sensor* const> sensors);

  // Once, before the first feel(): the sensors are fed from here from now on.
  void attach();

  // Fills the truth of the sensors that are due. The engines' step is done, the sensors' publish() comes
  // next.
  void feel(const world::WorldState& before, const world::WorldState& now,
            std::span<const collision::Contact> contacts, std::span<const dynamics::Wrench> pushes);

 private:
  struct Bound {
    sensors::Sensor* sensor;
    std::unique_ptr<Probe> probe;
  };

  const scene::Scene& scene_;
  std::vector<Bound> bound_;
  std::unique_ptr<RayWorld> rays_;  // null: nobody wants any
};

}  // namespace visum::sensing
