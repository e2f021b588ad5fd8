// Slider: B moves along the axis a of A and keeps its orientation. Five rows: T2 + R3.
//   place         t_i . (P_A - P) = 0                   t_i . v = 0,  t_i across a
//   orientation   (b_1 x a_1 + b_2 x a_2 + b_3 x a_3)/2 = 0, sin(angle) times an axis: fixed.h
//                                                       w = 0
//   free          v = q' a,  distance q = a . (P - P_A)
// v is taken at P on both bodies: A's lever is P - x_A, which grows with q. Symbols, sources: joint.h.
// Source: Featherstone (prismatic); for the orientation Luh.
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
