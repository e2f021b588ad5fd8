// Ball: B turns freely about P. Three rows: T3, the spherical joint of the paper's definitions (7) and (8):
//   place   P_A - P = 0                    v = 0
//   free    w, all three directions
// Alone, its impulse F solves (K_A + K_B) F = (P_A - P)/h, with both points at t+h and K = E/m - r~ J~^-1 r~,
// where r leads from the centre of mass to the point at t and J~ is the inertia in W. These are the paper's
// formulas for Delta v_1 and Delta v_2, with the two signs that slipped in print put right. Symbols, sources:
// joint.h.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::ball {

inline Held held(const JointSpec&, const JointPose&) {
  Held rows;
  add_all_shifts(rows);
  return rows;
}

inline Motion motion(const JointSpec&, const JointPose&) {
  Motion free;
  add_all_turns(free);
  return free;
}

inline Gap gap(const JointSpec&, const JointPose& pose) {
  return {Vector3d::Zero(), pose.pa - pose.pb};
}

}  // namespace visum::dynamics::impulse::ball
