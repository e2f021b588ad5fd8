// A joint as the solvers see it: where it sits on its two bodies, and what its kind says about a relative
// motion. The formulas of the kinds are beside this file, one page each. The pages use these symbols, all in
// W:
//
// clang-format off
//   A, B          the parent (or the world), and the child
//   x_A, x_B      their centres of mass
//   R_A, R_B      their orientations;  J_A, J_B  the joint's axes in A and in B: R_A J_A and R_B J_B are the
//                 joint's axes as the one and the other carries them (frame_a, frame_b)
//   P, P_A        the joint's point on B, and its counterpart on A
//   a, b          the axis as A carries it, and as B does;  c  a second one, that B carries
//   t_i           t_1 and t_2: unit vectors across an axis, and across each other (across(), directions.h)
//   (w, v)        relative motion of B against A: the angular velocity, and the velocity of P with both
//                 bodies taken at P: A's lever is P - x_A, not P_A - x_A
//   q, q'         coordinate of a free direction, and its rate
//   n~            the matrix of the cross product: n~ u = n x u
//
//   Rows, by what they hold (T translation, R rotation, and how many):
//   T3  the point P_A = P                             R3  the orientation
//   T2  the point on a line of A                      R2  two axes parallel
//   T1  the point in a plane of A                     R1  two axes perpendicular
//
// A page states three things: what is zero in place when the joint is closed, what is zero in velocity (the
// rows of Held), and what is free (the columns of Motion). The gap is the motion of B that would close the
// joint; it has the sign of P_A - P and of b x a. Sources, by the names that the pages use:
//   the paper     VISUM: A VR system for the interactive and dynamics simulation of mechatronic systems,
//                 section 5. Its definitions have numbers, (1) to (8); its formulas have none.
//   Featherstone  Rigid Body Dynamics Algorithms, Springer 2008: table 4.1, joints by their free directions
//   Shabana       Computational Dynamics, 3rd edition, Wiley 2010: chapter 7, joints by what they hold
//   Luh           Luh, Walker, Paul, Resolved-Acceleration Control of Mechanical Manipulators, IEEE
//                 Transactions on Automatic Control 25 (1980): an orientation's error by three cross products
// clang-format on
#pragma once

#include <Eigen/Core>
#include <array>

#include "server/world/world_model.h"

namespace visum::dynamics::impulse {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The constants of a joint between the engine's bodies.
struct JointSpec {
  world::JointKind kind = world::JointKind::kFixed;
  world::JointId id;
  int a = -1, b = -1;         // numbers among the engine's bodies; a = -1: A does not move
  Vector3d point_a, point_b;  // P_A and P, from the centre of mass in the body's P axes (a = -1: in W)
  Matrix3d frame_a, frame_b;  // J's axes in the bodies' P axes
  Vector3d axis_a, axis_b;    // axis_J in the same axes
  Vector3d zero_a, zero_b;    // a direction across the axis; A's and B's agree at angle 0
  Vector3d axis2_b;           // universal: axis2_J in B
  double lift = 0.0;          // screw: m per rad
  const world::Joint* model = nullptr;
};

// A joint with its bodies in a certain pose. The first four vectors must stay together: kernels write them as
// one (lanes/joints_kernels.h).
struct JointPose {
  Vector3d pa, pb;  // P_A, P
  Vector3d a, b;    // the axis as A carries it, and as B does
  // The bodies' P axes in W. They point into Bodies, and change when the bodies move.
  const Matrix3d* Ra = nullptr;
  const Matrix3d* Rb = nullptr;
  double angle = 0.0;  // screw: unwrapped; curve: the parameter
};

// Directions of relative motion, one per column.
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
