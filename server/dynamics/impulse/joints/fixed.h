// Fixed: B keeps its place and its orientation in A. Six rows: T3 + R3.
//   place         P_A - P = 0                           v = 0
//   orientation   (b_1 x a_1 + b_2 x a_2 + b_3 x a_3)/2 = 0,  a_i the columns of R_A J_A, b_i of R_B J_B
//                                                       w = 0
// The sum is sin(angle) times the axis of the turn that is missing. It is good for small gaps, as those of a
// step are. From 90 degrees on it falls, and at 180 it is 0: a joint that far apart does not notice. Symbols,
// sources: joint.h. Source: Luh; for the rows Shabana.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::fixed {

inline Held held(const JointSpec&, const JointPose&) {
  Held rows;
  add_all_turns(rows);
  add_all_shifts(rows);
  return rows;
}

inline Motion motion(const JointSpec&, const JointPose&) {
  return {};
}

inline Gap gap(const JointSpec& joint, const JointPose& pose) {
  return {turn_onto(joint, pose), pose.pa - pose.pb};
}

}  // namespace visum::dynamics::impulse::fixed
