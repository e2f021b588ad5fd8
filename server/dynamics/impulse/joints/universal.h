// Universal (Cardan): P is held, and the axis a of A stays perpendicular to the axis c of B. Four rows: T3 +
// R1.
//   place   P_A - P = 0                    v = 0
//   cross   e = a . c = 0                  e' = (w x c) . a = -n . w,  n = a x c
//   free    w = q1' a + q2' c
// The turn about n that closes e is n e/|n|^2. Symbols, sources: joint.h. Source: Shabana.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::universal {

// The axis c in W.
inline Vector3d second_axis(const JointSpec& joint, const JointPose& pose) {
  return *pose.Rb * joint.axis2_b;
}

inline Held held(const JointSpec& joint, const JointPose& pose) {
  Held rows;
  rows.add(pose.a.cross(second_axis(joint, pose)).normalized(), Vector3d::Zero());
  add_all_shifts(rows);
  return rows;
}

inline Motion motion(const JointSpec& joint, const JointPose& pose) {
  Motion free;
  free.add(pose.a, Vector3d::Zero());
  free.add(second_axis(joint, pose), Vector3d::Zero());
  return free;
}

inline Gap gap(const JointSpec& joint, const JointPose& pose) {
  const Vector3d c = second_axis(joint, pose), n = pose.a.cross(c);
  return {n * (pose.a.dot(c) / n.squaredNorm()), pose.pa - pose.pb};
}

}  // namespace visum::dynamics::impulse::universal
