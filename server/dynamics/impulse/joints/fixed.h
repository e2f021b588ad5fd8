// Fixed: B keeps its place and its orientation in A. Six rows: T3 + R3.
//   place         P_A - P = 0                                   v = 0
//   orientation   rotation vector of R_A J_A (R_B J_B)^T = 0    w = 0
// Symbols: joint.h. Source: Featherstone, Rigid Body Dynamics Algorithms (2008), table 4.1; the paper's
// joint of spherical pairs taken to rows of full rank.
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
