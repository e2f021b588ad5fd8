// Ball: B turns freely about P. Three rows: T3, the spherical joint of the paper (section 5):
//   place   delta = P_A - P = 0            v = 0
//   free    w, all three directions
// Its impulse F alone solves (K_A + K_B) F = delta/h, K = E/m - r~ J^-1 r~ (r~ the matrix of r x): the
// paper's formulas for the correcting impulse, with the two signs that slipped in print put right. Symbols:
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
