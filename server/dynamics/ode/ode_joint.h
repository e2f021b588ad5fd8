// One joint of the world as ODE has it: the joint itself, with stops, and a motor of its own beside it. The
// motor is apart because ODE's built-in one is replaced by a guess where a joint stands at a stop, and
// because a joint needs two rows: one for the drive's law or dry friction, one for damping.
//
// hwparts/joint.h as an ODE row, with J v the joint's velocity at the end of the tick and lambda the effort:
//     J v + cfm lambda = target_velocity,  -max_effort <= lambda <= max_effort,  cfm = compliance
#pragma once

#include <ode/ode.h>

#include <memory>

#include "hwparts/joint.h"
#include "server/dynamics/ode/ode_world.h"

namespace visum::dynamics::ode {

class OdeJoint {
 public:
  OdeJoint(OdeWorld& world, const world::WorldModel& model, world::JointId id);

  // Before the step, with the bodies in place.
  void apply(const hwparts::JointDrive& drive, const world::WorldState& state);
  // After the step: what drive, friction and damping transmitted.
  double effort() const;

 private:
  dJointID make_joint(OdeWorld& world) const;
  void place_joint(const world::Pose& X_WJ) const;
  void make_motor(OdeWorld& world, const Eigen::Vector3d& axis_W);
  void set_row(int row, double velocity, double compliance, double max_effort);
  void add_effort(double effort);

  const world::Joint& model_;
  const world::EngineSetting& setting_;
  world::JointId id_;
  dJointID joint_ = nullptr;
  dJointID motor_ = nullptr;                  // null for a joint without an axis to drive
  std::unique_ptr<dJointFeedback> feedback_;  // ODE keeps its address
  double feedforward_ = 0.0;
  Eigen::Vector3d axis_W_ = Eigen::Vector3d::Zero();  // as of apply()
};

}  // namespace visum::dynamics::ode
