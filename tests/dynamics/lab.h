// A world with its engines and collision stage, ticked by hand: the cycle without parts.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/dynamics/world_step.h"
#include "tests/dynamics/model_builder.h"

namespace visum::dynamics::testing {

class Lab {
 public:
  explicit Lab(world::WorldModel model);  // throws std::runtime_error for a faulty model

  // One tick. Stops at the first engine that reports a fault; otherwise all of their results together.
  StepResult step();
  // As many ticks as the time holds. Throws std::runtime_error with the fault's text if an engine reports
  // one.
  void run(double seconds);
  void run_ticks(int ticks);

  std::vector<std::byte> bytes() const;
  std::uint64_t hash() const;

  double tick_s() const { return 1e-9 * static_cast<double>(model.tick_ns); }
  hwparts::JointDrive& drive(const std::string& joint) { return drives[model.find_joint(joint).index()]; }
  const world::JointState& joint(const std::string& name) const {
    return state.joints[model.find_joint(name).index()];
  }
  world::BodyState& body(const std::string& name) { return state.bodies[model.find_body(name).index()]; }
  // Sum over the contacts of two bodies, N.
  double normal_force_between(const std::string& a, const std::string& b) const;
  double kinetic_energy() const;

  const world::WorldModel model;
  world::WorldState state;
  std::vector<hwparts::JointDrive> drives;
  std::vector<Wrench> wrenches;
  std::vector<collision::Contact> contacts;
  std::vector<std::unique_ptr<Engine>> engines;
  int warned_ticks = 0;

 private:
  collision::CollisionStage stage_;
  WorldStep world_step_;
  world::WorldState before_;
};

}  // namespace visum::dynamics::testing
