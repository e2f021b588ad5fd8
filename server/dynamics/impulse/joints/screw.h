// Screw: B turns about the axis a of A and moves along it by k = pitch/(2 pi) for each radian. Five rows:
// those of the cylindrical joint and
//   lift    s - k q = 0,  s = a . (P - P_A), q the unwrapped angle          a . v - k a . w = 0
//   free    w = q' a,  v = k q' a
// Symbols, sources: joint.h. Source: Featherstone (helical).
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::screw {

inline Held held(const JointSpec& joint, const JointPose& pose) {
  Held rows;
  add_turns_across(pose.a, rows);
  add_shifts_across(pose.a, rows);
  const double scale = 1.0 / std::sqrt(1.0 + joint.lift * joint.lift);
  rows.add(-joint.lift * scale * pose.a, scale * pose.a);
  return rows;
}

inline Motion motion(const JointSpec& joint, const JointPose& pose) {
  Motion free;
  free.add(pose.a, joint.lift * pose.a);
  return free;
}

inline Gap gap(const JointSpec& joint, const JointPose& pose) {
  const Vector3d off = pose.pa - pose.pb;
  const double lift = -pose.a.dot(off) - joint.lift * pose.angle;
  return {turn_onto(pose.b, pose.a), without(pose.a, off) - lift * pose.a};
}

}  // namespace visum::dynamics::impulse::screw
