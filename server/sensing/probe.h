// What the world gives a sensor: the truth of its quantity at the end of a tick. A seam with a table of kinds
// (sensor_kinds.cc), of the same names as the sensors in hwparts/sensors, which make of it what is read.
#pragma once

#include <memory>
#include <span>

#include "hwparts/sensors/sensor.h"
#include "protocol/config/config.h"
#include "server/collision/collision.h"
#include "server/dynamics/engine.h"
#include "server/scene/scene.h"
#include "server/sensing/ray_world.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::sensing {

// One tick of the world, as a sensor sees it.
struct Moment {
  const world::WorldModel& model;
  const world::WorldState& before;               // when the tick began
  const world::WorldState& now;                  // when it ended
  std::span<const collision::Contact> contacts;  // with the forces of the tick
  std::span<const dynamics::Wrench> pushes;      // of the tick
  double tick_s;
  const RayWorld* rays;  // placed as of `now`; null where no probe wants rays
};

// Where a sensor sits.
struct Mount {
  world::BodyId body;    // invalid: in the world
  world::Pose X_BS;      // the sensor's frame on the body, or in W
  world::JointId joint;  // of those that measure one
};

class Probe {
 public:
  virtual ~Probe() = default;
  virtual bool wants_rays() const { return false; }
  // Once, before the first tick: gives the sensor what else it needs of the world. The probe outlives its
  // use.
  virtual void attach(sensors::Sensor&) {}
  // Fills all of `truth`; its length is the sensor's. Does not allocate.
  virtual void measure(const Moment& moment, std::span<double> truth) = 0;
};

struct ProbeContext {
  const scene::Scene& scene;
  const Mount& mount;
  const config::Node& config;  // the sensor's entry, checked already by the sensor
};

struct ProbeKind {
  const char* name;
  std::unique_ptr<Probe> (*make)(const ProbeContext&);  // throws ConfigError
};
std::span<const ProbeKind> probe_kinds();
std::unique_ptr<Probe> make_probe(const std::string& kind, const ProbeContext& context);

// X_WS as of a state.
world::Pose pose_of(const Mount& mount, const world::WorldModel& model, const world::WorldState& state);
// Of the sensor's origin, in W.
Eigen::Vector3d velocity_of(const Mount& mount, const world::WorldModel& model,
                            const world::WorldState& state);

}  // namespace visum::sensing
