// Hinge: B turns about the axis a through P. Five rows: T3 + R2.
//   place   P_A - P = 0                    v = 0
//   axis    b x a = 0                      t_i . w = 0,  t_i across a
//   free    w = q' a,  angle q
// The paper (section 5, below definition (8)) makes a revolute joint of two spherical ones. These are six
// rows of rank five, which Gauss-Seidel can solve and a direct solution cannot. Symbols, sources: joint.h.
// Source: Featherstone.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::hinge {

inline Held held(const JointSpec&, const JointPose& pose) {
  Held rows;
  add_turns_across(pose.a, rows);
  add_all_shifts(rows);
  return rows;
}

inline Motion motion(const JointSpec&, const JointPose& pose) {
  Motion free;
  free.add(pose.a, Vector3d::Zero());
  return free;
}

inline Gap gap(const JointSpec&, const JointPose& pose) {
  return {turn_onto(pose.b, pose.a), pose.pa - pose.pb};
}

}  // namespace visum::dynamics::impulse::hinge
