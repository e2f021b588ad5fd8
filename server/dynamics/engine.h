// An engine moves a set of bodies forward in time; the paper calls it a controller. This interface is the
// seam between the simulation and ODE, the impulse engine or a plug-in's engine. Engines hold no truth of
// their own: they read WorldState and write it.
//
// Order of calls: make_engine(), which throws std::runtime_error for settings that it cannot take. Then
// step() any number of times on the tick's thread, each time with whatever state it is given, even a restored
// one or one of another era. step() never aborts, never throws and never leaves a NaN behind silently: the
// StepResult says what went wrong.
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
  // All contacts of the world. An engine acts on those that touch its bodies, and fills in their forces. A
  // body of another engine moves as that engine moves it.
  std::span<collision::Contact> contacts;
  std::span<const hwparts::JointDrive> drives;  // by JointId
  std::span<const Wrench> wrenches;
};

struct StepResult {
  bool ok = true;
  std::string fault;    // if !ok: names the body or joint; the state must then not be used
  bool warned = false;  // if ok: the solver did not reach its bounds, and went on with what it had
  // If ok: the work of the tick has met its limit (EngineSetting::work_limit), and ended with the best that
  // was reached. `fell_short` names the bodies that should have been held better, at most kMostNamed.
  bool limited = false;
  std::vector<world::BodyId> fell_short;
  std::uint64_t work = 0;    // what the tick has taken, in the units of the limit; 0: the engine counts none
  std::size_t standing = 0;  // contacts that were not computed anew: they stand, and give what they gave

  static constexpr std::size_t kMostNamed = 16;
};

// Simulation owns the engines. The tick's thread is the only one that calls them.
class Engine {
 public:
  virtual ~Engine() = default;
  // Moves this engine's bodies (Body::engine is its index) from t_k to t_k+1. Sets JointState::effort of its
  // joints; the caller measures their positions and velocities.
  virtual StepResult step(const StepInput& input, world::WorldState& state) = 0;
  // True if a tick may be made several times, from the same state with other forces. Contacts with bodies of
  // other such engines then share loads (coupling.h). Engines of plug-ins are called once per tick.
  virtual bool may_repeat() const { return false; }
};

}  // namespace visum::dynamics
