// One joint of the world in ODE: ODE's joint with its stops, and a separate motor beside it. The motor is
// separate for two reasons. ODE replaces its built-in motor by a guess while a joint is at a stop. And a
// joint needs two rows: one for the drive's law or dry friction, one for damping.
//
// hwparts/joint.h as an ODE row, where J v is the joint's velocity at the end of the tick and lambda the
// effort:
//     J v + cfm lambda = target_velocity,  -max_effort <= lambda <= max_effort,  cfm = compliance
#pragma once

#include <memory>

#include "hwparts/joint.h"
#include "server/dynamics/ode/ode_library.h"
#include "server/dynamics/ode/ode_world.h"

namespace visum::dynamics::ode {

// The Mechanism of ode_engine.cc owns it; tick's thread. The constructor throws std::runtime_error for a kind
// of joint that ODE does not have.
class OdeJoint {
 public:
  OdeJoint(OdeWorld& world, const world::WorldModel& model, world::JointId id);

  // Before the step, with the bodies in place: sets stops, motor and feedforward.
  void apply(const hwparts::JointDrive& drive, const world::WorldState& state);
  // After the step: the effort that drive, friction and damping transmitted, N·m or N.
  double effort() const;

 private:
  dJointID make_joint(OdeWorld& world) const;
  // Sets anchor and axes, with the bodies in place.
  void place_joint(const world::Pose& X_WJ) const;
  void make_motor(OdeWorld& world, const Eigen::Vector3d& axis_W);
  // Sets one row of the motor: target velocity, compliance (CFM) and limit.
  void set_row(int row, double velocity, double compliance, double max_effort);
  void add_effort(double effort);

  const world::Joint& model_;
  const world::EngineSetting& setting_;
  world::JointId id_;
  dJointID joint_ = nullptr;
  dJointID motor_ = nullptr;                  // null if the joint has no axis to drive
  std::unique_ptr<dJointFeedback> feedback_;  // ODE keeps its address
  double feedforward_ = 0.0;
  Eigen::Vector3d axis_W_ = Eigen::Vector3d::Zero();  // at the last apply()
};

}  // namespace visum::dynamics::ode
