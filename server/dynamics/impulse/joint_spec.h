// Applies the kinds of joint to a joint between the engine's bodies. Each kind has a page of its own
// (joints/); here they are called by kind, in the bodies' present pose or where the look-ahead has led.
#pragma once

#include <cmath>

#include "server/dynamics/impulse/bodies.h"
#include "server/dynamics/impulse/joints/joint.h"
#include "server/world/world_model.h"

namespace visum::dynamics::impulse {

// The larger of two gaps; NaN counts as the largest.
inline double larger(double gap, double largest) {
  return gap <= largest || std::isnan(largest) ? largest : gap;
}

// The directions that a joint holds, those in which it is free (only of kinds that can carry a body,
// world/joint_kinds.h), and the motion that would close it.
Held held_directions(const JointSpec& joint, const JointPose& pose);
Motion motion_directions(const JointSpec& joint, const JointPose& pose);
Gap joint_gap(const JointSpec& joint, const JointPose& pose);

// Direction of the axis of a kind with one coordinate. An impulse along it is an impulse on the coordinate.
// For a screw it is the turn alone, since the lift follows from it.
struct AxisDirection {
  Vector3d w, v;
};
AxisDirection axis_direction(const JointSpec& joint, const JointPose& pose);

// Makes the spec of a joint: points and axes in the bodies' P axes.
JointSpec make_spec(const world::WorldModel& model, const Bodies& bodies, world::JointId id);

// The joint's pose at t, where `position` is its last position, and where the look-ahead over h has led from
// `last`.
JointPose pose_now(const JointSpec& joint, const Bodies& bodies, double position);
JointPose pose_ahead(const JointSpec& joint, const Bodies& bodies, const world::JointState& last, double h);

// The position that is expected there: `last.position`, for a screw moved on by h.
double position_ahead(const JointSpec& joint, const world::JointState& last, double h);
// Sets the pose's angle from its points and axes; `position` as above.
void find_angle(const JointSpec& joint, double position, JointPose& pose);

// The angle from A to B about the axis, unwrapped to the turn that is nearest to `near`.
double joint_angle(const JointSpec& joint, const JointPose& pose, double near);

}  // namespace visum::dynamics::impulse
