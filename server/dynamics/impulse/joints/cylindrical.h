// Cylindrical: B turns about the axis a of A and slides along it. Four rows: T2 + R2.
//   place   t_i . (P_A - P) = 0            t_i . v = 0,  t_i across a
//   axis    b x a = 0                      t_i . w = 0
//   free    w = q1' a,  v = q2' a
// Symbols, sources: joint.h. Source: Featherstone.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::cylindrical {

inline Held held(const JointSpec&, const JointPose& pose) {
  Held rows;
  add_turns_across(pose.a, rows);
  add_shifts_across(pose.a, rows);
  return rows;
}

inline Motion motion(const JointSpec&, const JointPose& pose) {
  Motion free;
  free.add(pose.a, Vector3d::Zero());
  free.add(Vector3d::Zero(), pose.a);
  return free;
}

inline Gap gap(const JointSpec&, const JointPose& pose) {
  return {turn_onto(pose.b, pose.a), without(pose.a, pose.pa - pose.pb)};
}

}  // namespace visum::dynamics::impulse::cylindrical
