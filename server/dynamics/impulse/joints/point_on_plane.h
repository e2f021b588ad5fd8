// Point on plane: P stays in the plane of A through P_A with the normal a. One row: T1.
//   place   a . (P_A - P) = 0              a . v = 0
// v is taken at P on both bodies, and so contains the turning of the normal. Symbols, sources: joint.h.
// Source: Shabana.
#pragma once

#include "server/dynamics/impulse/joints/directions.h"

namespace visum::dynamics::impulse::point_on_plane {

inline Held held(const JointSpec&, const JointPose& pose) {
  Held rows;
  rows.add(Vector3d::Zero(), pose.a);
  return rows;
}

inline Gap gap(const JointSpec&, const JointPose& pose) {
  return {Vector3d::Zero(), pose.a * pose.a.dot(pose.pa - pose.pb)};
}

}  // namespace visum::dynamics::impulse::point_on_plane
