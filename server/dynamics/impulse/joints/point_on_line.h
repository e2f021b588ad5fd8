// Point on line: P stays on the line of A through P_A along a. Two rows: T2.
//   place   t_i . (P_A - P) = 0            t_i . v = 0,  t_i across a
// v is taken at P on both bodies. Symbols, sources: joint.h. Source: Shabana.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::point_on_line {

inline Held held(const JointSpec&, const JointPose& pose) {
  Held rows;
  add_shifts_across(pose.a, rows);
  return rows;
}

inline Gap gap(const JointSpec&, const JointPose& pose) {
  return {Vector3d::Zero(), without(pose.a, pose.pa - pose.pb)};
}

}  // namespace visum::dynamics::impulse::point_on_line
