// One dWorld with a dBody for each body that the engine moves, and a kinematic stand-in for each that another
// engine moves. Holds no truth: load() before each step, store() after.
#pragma once

#include <ode/ode.h>

#include <vector>

#include "server/dynamics/ode/ode_handles.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::dynamics::ode {

class OdeWorld {
 public:
  OdeWorld(const world::WorldModel& model, std::int32_t engine_index);

  dWorldID id() const { return world_.get(); }

  // Null for what never moves: fixed bodies, and the world itself (an invalid id).
  dBodyID body(world::BodyId id) const { return id.valid() ? bodies_[id.index()] : nullptr; }
  bool owns(world::BodyId id) const;
  const world::WorldModel& model() const { return model_; }

  // Places a body's link frame, at rest: where joints are made.
  void place_link(world::BodyId id, const world::Pose& X_WB);

  // Poses and velocities bit for bit, forces cleared. Stand-ins take part in a step only when woken after
  // this.
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
