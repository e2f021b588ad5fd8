// Pieces that several kinds of joint share. Symbols: joint.h.
#pragma once

#include <cmath>

#include "server/dynamics/impulse/joints/joint.h"

namespace visum::dynamics::impulse {

// Two unit vectors across the unit vector n; (n, first, second) is right-handed. Duff et al., Building an
// orthonormal basis, revisited, JCGT 6 (2017), formula of listing 3.
struct Across {
  Vector3d first, second;
};
inline Across across(const Vector3d& n) {
  const double sign = n.z() < 0.0 ? -1.0 : 1.0;
  const double p = -1.0 / (sign + n.z());
  const double q = n.x() * n.y() * p;
  return {{1.0 + sign * n.x() * n.x() * p, sign * q, -sign * n.x()}, {q, sign + n.y() * n.y() * p, -n.y()}};
}

template <int kMost>
void add_all_turns(Directions<kMost>& to) {
  for (int i = 0; i < 3; ++i) to.add(Vector3d::Unit(i), Vector3d::Zero());
}
template <int kMost>
void add_all_shifts(Directions<kMost>& to) {
  for (int i = 0; i < 3; ++i) to.add(Vector3d::Zero(), Vector3d::Unit(i));
}
template <int kMost>
void add_turns_across(const Vector3d& axis, Directions<kMost>& to) {
  const auto [first, second] = across(axis);
  to.add(first, Vector3d::Zero());
  to.add(second, Vector3d::Zero());
}
template <int kMost>
void add_shifts_across(const Vector3d& axis, Directions<kMost>& to) {
  const auto [first, second] = across(axis);
  to.add(Vector3d::Zero(), first);
  to.add(Vector3d::Zero(), second);
}

// The turn that takes b to a; its length is the sine of the angle between them.
inline Vector3d turn_onto(const Vector3d& b, const Vector3d& a) {
  return b.cross(a);
}

// The part of u across the axis.
inline Vector3d without(const Vector3d& axis, const Vector3d& u) {
  return u - axis * axis.dot(u);
}

// The turn that takes B's frame to A's. Half the sum over the axes of b_i x a_i is sin(angle) times the axis
// of the turn. It is 0 at 180 degrees, too (fixed.h). Luh (joint.h).
inline Vector3d turn_onto(const JointSpec& joint, const JointPose& pose) {
  const Matrix3d to = *pose.Ra * joint.frame_a, from = *pose.Rb * joint.frame_b;
  return 0.5 * (from.col(0).cross(to.col(0)) + from.col(1).cross(to.col(1)) + from.col(2).cross(to.col(2)));
}

}  // namespace visum::dynamics::impulse
