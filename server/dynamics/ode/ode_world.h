// One dWorld, with a dBody for each body that the engine moves, and a kinematic stand-in for each body that
// another engine moves. It holds no truth: call load() before each step and store() after it.
#pragma once

#include <vector>

#include "server/dynamics/ode/ode_handles.h"
#include "server/dynamics/ode/ode_library.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::dynamics::ode {

// The Mechanism of ode_engine.cc owns it; tick's thread. ODE's failures come as OdeError (ode_guard.h).
class OdeWorld {
 public:
  OdeWorld(const world::WorldModel& model, std::int32_t engine_index);

  dWorldID id() const { return world_.get(); }

  // Null for everything that never moves: fixed bodies, and the world itself (an invalid id).
  dBodyID body(world::BodyId id) const { return id.valid() ? bodies_[id.index()] : nullptr; }
  bool owns(world::BodyId id) const;
  const world::WorldModel& model() const { return model_; }

  // Places a body's link frame, at rest, so that joints can be made there.
  void place_link(world::BodyId id, const world::Pose& X_WB);

  // Loads poses and velocities bit for bit, and clears forces. A stand-in takes part in a step only if
  // wake_stand_in() is called after this.
  void load(const world::WorldState& state);
  void wake_stand_in(world::BodyId id, const world::WorldState& state);
  void store(world::WorldState& state) const;

 private:
  const world::WorldModel& model_;
  std::int32_t engine_index_;
  WorldHandle world_;
  std::vector<dBodyID> bodies_;  // by BodyId
  std::vector<world::BodyId> own_;
  std::vector<world::BodyId> stand_ins_;
};

}  // namespace visum::dynamics::ode
