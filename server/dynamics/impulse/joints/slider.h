// Slider: B moves along the axis a of A and keeps its orientation. Five rows: T2 + R3.
//   place         t_i . (P_A - P) = 0 across a                  t_i . v = 0
//   orientation   rotation vector of R_A J_A (R_B J_B)^T = 0    w = 0
//   free          v = q' a,  distance q = a . (P - P_A)
// v is taken at P on both bodies: A's lever is P - x_A, which grows with q. Symbols: joint.h.
// Source: Featherstone, table 4.1.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::slider {

inline Held held(const JointSpec&, const JointPose& pose) {
  Held rows;
  add_all_turns(rows);
  add_shifts_across(pose.a, rows);
  return rows;
}

inline Motion motion(const JointSpec&, const JointPose& pose) {
  Motion free;
  free.add(Vector3d::Zero(), pose.a);
  return free;
}

inline Gap gap(const JointSpec& joint, const JointPose& pose) {
  return {turn_onto(joint, pose), without(pose.a, pose.pa - pose.pb)};
}

}  // namespace visum::dynamics::impulse::slider
