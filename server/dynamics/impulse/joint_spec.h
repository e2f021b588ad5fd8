// What the kinds of joint (joints/, one page each) say of a joint between the engine's bodies: by kind, and
// in the bodies' present pose or where the look-ahead has led.
#pragma once

#include <cmath>

#include "server/dynamics/impulse/bodies.h"
#include "server/dynamics/impulse/joints/joint.h"
#include "server/world/world_model.h"

namespace visum::dynamics::impulse {

// Of two gaps; a NaN is the larger one.
inline double larger(double gap, double largest) {
  return gap <= largest || std::isnan(largest) ? largest : gap;
}

// What a kind says. `motion` only of kinds that carry (world/joint_kinds.h).
Held held_directions(const JointSpec& joint, const JointPose& pose);
Motion motion_directions(const JointSpec& joint, const JointPose& pose);
Gap joint_gap(const JointSpec& joint, const JointPose& pose);

// The direction of the axis of a kind with one coordinate: an impulse along it is one on the coordinate (of a
// screw the turn alone: what it lifts follows).
struct AxisDirection {
  Vector3d w, v;
};
AxisDirection axis_direction(const JointSpec& joint, const JointPose& pose);

JointSpec make_spec(const world::WorldModel& model, const Bodies& bodies, world::JointId id);

// At t, where `position` is the joint's last one; where the look-ahead over h has led, from how it was at t.
JointPose pose_now(const JointSpec& joint, const Bodies& bodies, double position);
JointPose pose_ahead(const JointSpec& joint, const Bodies& bodies, const world::JointState& last, double h);

// Where a joint's position is expected there.
double position_ahead(const JointSpec& joint, const world::JointState& last, double h);
// What a pose says besides points and axes, from them: `position` as above.
void find_angle(const JointSpec& joint, double position, JointPose& pose);

// The angle from A to B about the axis that is nearest to `near`.
double joint_angle(const JointSpec& joint, const JointPose& pose, double near);

}  // namespace visum::dynamics::impulse
