// A joint as the solvers see it: where it sits on its two bodies, and what its kind says about a relative
// motion. The kinds' formulas are beside this, one page each.
//
// Symbols, all in W: A the parent (or the world), B the child; P the joint's point on B, P_A its counterpart
// on A; a the axis fixed to A, b the same axis fixed to B. A relative motion of B against A is the pair
// (w, v): the angular velocity, and the velocity of P with both bodies taken at P.
#pragma once

#include <Eigen/Core>
#include <array>

#include "server/world/world_model.h"

namespace visum::dynamics::impulse {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct JointSpec {
  world::JointKind kind = world::JointKind::kFixed;
  world::JointId id;
  int a = -1, b = -1;         // numbers among the engine's bodies; a = -1: what stands still
  Vector3d point_a, point_b;  // P_A and P, from the centre of mass in the body's P axes (a = -1: in W)
  Matrix3d frame_a, frame_b;  // J's axes in the bodies' P axes
  Vector3d axis_a, axis_b;    // axis_J, likewise
  Vector3d zero_a, zero_b;    // a direction across the axis, the same on both at angle 0
  Vector3d axis2_b;           // universal: axis2_J in B
  double lift = 0.0;          // screw: m per rad
  const world::Joint* model = nullptr;
};

// A joint with its bodies in a certain pose. The four vectors stand together, as kernels write them
// (lanes/joints_kernels.h).
struct JointPose {
  Vector3d pa, pb;  // P_A, P
  Vector3d a, b;    // the axis, as A and as B carry it
  // The bodies' P axes in W: theirs, good until they move.
  const Matrix3d* Ra = nullptr;
  const Matrix3d* Rb = nullptr;
  double angle = 0.0;  // screw: unwrapped; curve: the parameter
};

// Directions of relative motion, a column each.
template <int kMost>
struct Directions {
  int count = 0;
  std::array<Vector3d, kMost> w, v;

  void add(const Vector3d& angular, const Vector3d& linear) {
    w[static_cast<std::size_t>(count)] = angular;
    v[static_cast<std::size_t>(count)] = linear;
    ++count;
  }
};
using Held = Directions<6>;
using Motion = Directions<3>;

// The relative motion that would close the joint, rad and m.
struct Gap {
  Vector3d turn = Vector3d::Zero();
  Vector3d shift = Vector3d::Zero();
};

}  // namespace visum::dynamics::impulse
