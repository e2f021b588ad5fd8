// An engine moves a set of bodies forward in time. The seam behind which ODE and the impulse engine stand;
// the paper calls it a controller. Engines hold no truth of their own: they read WorldState and write it.
//
// Order of calls: make_engine() (throws std::runtime_error with a clear word for settings it cannot take),
// then step() any number of times on the tick's thread, each time on whatever state it is given: a restored
// one, another era's. step() never aborts, never throws, never leaves a NaN behind silently: what goes wrong
// is in the StepResult.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hwparts/joint.h"
#include "server/collision/collision.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::dynamics {

// A force and torque on a body during the next tick, at its centre of mass, in W.
struct Wrench {
  world::BodyId body;
  Eigen::Vector3d force_n;
  Eigen::Vector3d torque_nm;
};

struct StepInput {
  double tick_s;
  // All of the world; an engine acts on those that touch its bodies and fills their forces. A body of
  // another engine moves as it moves.
  std::span<collision::Contact> contacts;
  std::span<const hwparts::JointDrive> drives;  // by JointId
  std::span<const Wrench> wrenches;
};

struct StepResult {
  bool ok = true;
  std::string fault;    // where !ok: names body or joint. The state is then not to be used.
  bool warned = false;  // where ok: the solver fell short of what it was set to, and went on with what it had
};

class Engine {
 public:
  virtual ~Engine() = default;
  // Moves this engine's bodies (Body::engine == its index) from t_k to t_k+1. Sets JointState::effort of its
  // joints; position and velocity of joints are measured by the caller.
  virtual StepResult step(const StepInput& input, world::WorldState& state) = 0;
};

}  // namespace visum::dynamics
