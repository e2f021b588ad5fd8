// How a body turns while nothing touches it: the paper's Integrate() without its Taylor series. The angular
// momentum L = J w is constant in W; the ways differ in the orientation that they find.
//
// Symbols: R orientation of the principal axes, J1 J2 J3 principal moments, L_k the momentum about axis k of
// the body, exp(u) the rotation by |u| about u.
//   ball  R' = exp(h L/J) R
//   top   R' = exp(h L/J1) R exp(h L_3 (1/J3 - 1/J1) e_3)           exact: Euler's symmetric top
//   else  R' = R X(h/2) Y(h/2) Z(h) Y(h/2) X(h/2), each a rotation about a principal axis by h L_k/J_k that
//         turns L in the body with it: McLachlan, Explicit Lie-Poisson integration and the Euler equations,
//         Phys. Rev. Lett. 71 (1993); Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.5. Second
//         order, symmetric; |L| is kept to rounding.
#pragma once

#include "server/dynamics/impulse/bodies.h"

namespace visum::dynamics::impulse {

// The orientation after h, of a body with orientation q (matrix R) and angular velocity w in W. Unit.
Quaterniond fly(const BodyConstants& body, const Quaterniond& q, const Matrix3d& R, const Vector3d& w,
                double h);

// exp(u): the rotation by |u| about u, in W.
Quaterniond rotation(const Vector3d& u);

// q is a product of unit quaternions: one step of Newton's square root brings it back to unit length.
inline Quaterniond renormalised(const Quaterniond& q) {
  return Quaterniond(q.coeffs() * (1.5 - 0.5 * q.squaredNorm()));
}

}  // namespace visum::dynamics::impulse
