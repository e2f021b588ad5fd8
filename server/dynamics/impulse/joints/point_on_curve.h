// Point on curve: P stays on the curve c(u) of A (world/curve.h), here given in W. Two rows across the
// tangent c' at the nearest u:
//   place   c(u) - P = 0, u from (P - c) . c' = 0        t_i . v = 0,  t_i across c'
// u is followed from step to step, so a curve may cross itself. Symbols, sources: joint.h. Source: Shabana,
// with u eliminated by the foot of the perpendicular.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::point_on_curve {

// Unit tangent of the curve at the pose's parameter, in W.
inline Vector3d tangent(const JointSpec& joint, const JointPose& pose) {
  return (*pose.Ra * (joint.frame_a * joint.model->curve_J.at(pose.angle).tangent)).normalized();
}

inline Held held(const JointSpec& joint, const JointPose& pose) {
  Held rows;
  add_shifts_across(tangent(joint, pose), rows);
  return rows;
}

inline Gap gap(const JointSpec& joint, const JointPose& pose) {
  const Vector3d foot = pose.pa + *pose.Ra * (joint.frame_a * joint.model->curve_J.at(pose.angle).p);
  return {Vector3d::Zero(), without(tangent(joint, pose), foot - pose.pb)};
}

// The parameter of the point on the curve that is nearest to P, near the last one.
inline double parameter(const JointSpec& joint, const JointPose& pose, double near) {
  return joint.model->curve_J.nearest(
      joint.frame_a.transpose() * (pose.Ra->transpose() * (pose.pb - pose.pa)), near);
}

}  // namespace visum::dynamics::impulse::point_on_curve
