// A probe measures the truth for one sensor: its quantity in the world at the end of a tick. The sensor
// itself (hwparts/sensors) makes a reading of that truth: later, rounded, noisy. The kinds of probe stand in
// a table (probe_kinds.cc), under the same names as the kinds of sensor. Senses owns the probes, on the
// tick's thread.
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

// Everything that a probe may know of one tick.
struct Moment {
  const world::WorldModel& model;
  const world::WorldState& before;               // when the tick began
  const world::WorldState& now;                  // when it ended
  std::span<const collision::Contact> contacts;  // of the tick, with their forces
  std::span<const dynamics::Wrench> pushes;      // of the tick
  double tick_s;
  const RayWorld* rays;  // the world as of `now`; null where no probe wants rays
};

// Where a sensor sits.
struct Mount {
  world::BodyId body;    // invalid: fixed in the world
  world::Pose X_BS;      // the sensor's frame on the body, or in W
  world::JointId joint;  // for sensors that measure a joint
};

class Probe {
 public:
  virtual ~Probe() = default;
  virtual bool wants_rays() const { return false; }
  // Called once, before the first tick. Gives the sensor what it needs beside the truth; the sensor may use
  // that until another probe is attached.
  virtual void attach(sensors::Sensor&) {}
  // Fills all of `truth`, whose length the sensor has chosen. Must not allocate.
  virtual void measure(const Moment& moment, std::span<double> truth) = 0;
};

struct ProbeContext {
  const scene::Scene& scene;
  const Mount& mount;
  const config::Node& config;  // the sensor's entry, which the sensor has checked already
};

struct ProbeKind {
  const char* name;
  std::unique_ptr<Probe> (*make)(const ProbeContext&);  // throws ConfigError
};
std::span<const ProbeKind> probe_kinds();
// Throws ConfigError where the entry is wrong. Every kind of sensor has a probe; a missing one is a bug.
std::unique_ptr<Probe> make_probe(const std::string& kind, const ProbeContext& context);

// X_WS, the pose of the sensor's frame in a state.
world::Pose pose_of(const Mount& mount, const world::WorldModel& model, const world::WorldState& state);
// The velocity of the sensor's origin, in W.
Eigen::Vector3d velocity_of(const Mount& mount, const world::WorldModel& model,
                            const world::WorldState& state);

}  // namespace visum::sensing
