// The flight of bodies, four at once: the paper's Integrate() without its Taylor series. The angular momentum
// L = J w is constant in W; the orientation is found in one of three ways.
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

#include "server/dynamics/impulse/lanes/bodies_data.h"
#include "server/dynamics/impulse/lanes/vectors.h"

namespace visum::dynamics::impulse {
namespace {

// The tops' own axis in W.
VISUM_LANES_INLINE Vectors axes_of_tops(const BodyArrays& of, const BodyBlock& block) {
  return load_vectors(moved(Four{of.R, block.matrix}, 3 * block.axis));
}

// The top's formula above, with e_3 in W: exp(h L/J1) exp(h L_3 (1/J3 - 1/J1) e_3) q.
VISUM_LANES_INLINE Quaternions fly_tops(const BodyArrays& of, const BodyBlock& block, Quaternions q,
                                        Vectors w, double h) {
  const Vectors axis = axes_of_tops(of, block);
  const Lanes ratio = load(block.moments[2]) * load(block.inverse_moments[0]);
  const Lanes spin = dot(axis, w);  // w_3 = L_3/J3
  // L/J1 = w + (J3/J1 - 1) w_3 e_3.
  const Vectors precession = w + ((ratio - all(1.0)) * spin) * axis;
  const Quaternions own = rotations((all(h) * spin * (all(1.0) - ratio)) * axis);
  return rotations(h * precession) * (own * q);
}

// One of the five rotations: R <- R rot(angle about axis k), L <- rot(-angle) L.
VISUM_LANES_INLINE void turn_about(Lanes angle, Lanes& qk, Lanes& qi, Lanes& qj, Lanes& qw, Lanes& Li,
                                   Lanes& Lj) {
  const Lanes half = all(0.5) * angle;
  const Turns turn = turns(half * half);
  const Lanes s = half * turn.sin_share, c = turn.cos;
  const Lanes w = qw, k = qk, i = qi, j = qj;
  qw = c * w - s * k;
  qk = c * k + s * w;
  qi = c * i + s * j;
  qj = c * j - s * i;
  const Lanes sin = all(2.0) * s * c, cos = all(1.0) - all(2.0) * s * s;
  const Lanes li = Li, lj = Lj;
  Li = cos * li + sin * lj;
  Lj = cos * lj - sin * li;
}

// Bodies with three different moments: the five rotations.
VISUM_LANES_INLINE Quaternions fly_others(const BodyArrays& of, const BodyBlock& block, Quaternions q,
                                          Vectors w, double h) {
  const Matrices R = load_matrices(Four{of.R, block.matrix});
  Lanes Lx = load(block.moments[0]) * dot(R.column[0], w);
  Lanes Ly = load(block.moments[1]) * dot(R.column[1], w);
  Lanes Lz = load(block.moments[2]) * dot(R.column[2], w);
  const Lanes ix = all(0.5 * h) * load(block.inverse_moments[0]),
              iy = all(0.5 * h) * load(block.inverse_moments[1]);
  const Lanes iz = all(h) * load(block.inverse_moments[2]);
  turn_about(ix * Lx, q.x, q.y, q.z, q.w, Ly, Lz);
  turn_about(iy * Ly, q.y, q.z, q.x, q.w, Lz, Lx);
  turn_about(iz * Lz, q.z, q.x, q.y, q.w, Lx, Ly);
  turn_about(iy * Ly, q.y, q.z, q.x, q.w, Lz, Lx);
  turn_about(ix * Lx, q.x, q.y, q.z, q.w, Ly, Lz);
  return q;
}

// Free flight over h: parabola, and rotation with constant angular momentum.
void fly(const BodyArrays& of, const BodyBlock* blocks, std::size_t count, double h, const double* gravity) {
  const Vectors fall = (0.5 * h * h) * everywhere(gravity);
  for (const BodyBlock* block = blocks; block != blocks + count; ++block) {
    const Vectors x = load_vectors(Four{of.x, block->vector}), v = load_vectors(Four{of.v, block->vector});
    store_vectors(Four{of.x1, block->vector}, x + h * v + fall);
    const Vectors w = load_vectors(Four{of.w, block->vector});
    const Quaternions q = load_quaternions(Four{of.q, block->quaternion});
    // Four that stand still need no rotations, which are most of a flight.
    const bool turns = !is_zero(w.x) || !is_zero(w.y) || !is_zero(w.z);
    const Quaternions q1 = renormalised(!turns       ? q
                                        : block->top ? fly_tops(of, *block, q, w, h)
                                                     : fly_others(of, *block, q, w, h));
    store_quaternions(Four{of.q1, block->quaternion}, q1);
    store_matrices(Four{of.R1, block->matrix}, matrices(q1));
  }
}

// Changes the flight by h times a change of velocities, to first order.
void nudge(const BodyArrays& of, const BodyBlock* blocks, std::size_t count, double h, const double* dv,
           const double* dw) {
  for (const BodyBlock* block = blocks; block != blocks + count; ++block) {
    const Four<double> x1{of.x1, block->vector}, q1{of.q1, block->quaternion};
    store_vectors(x1, load_vectors(x1) + h * load_vectors(Four{dv, block->answer}));
    const Vectors u = (0.5 * h) * load_vectors(Four{dw, block->answer});
    const Quaternions q = renormalised(Quaternions{u.x, u.y, u.z, all(1.0)} * load_quaternions(q1));
    store_quaternions(q1, q);
    store_matrices(Four{of.R1, block->matrix}, matrices(q));
  }
}

// The largest component of any angular velocity in W, rad/s.
double largest_turn(const BodyArrays& of, const BodyBlock* blocks, std::size_t count) {
  Lanes most = all(0.0);
  for (const BodyBlock* block = blocks; block != blocks + count; ++block)
    most = largest(load_vectors(Four{of.w, block->vector}), most);
  return largest_of(most);
}

struct Inertias {
  Matrices of, inverse;
};

// Inertia of tops with the axis a: m E + (n - m) a a^T, with n along and m across the axis.
VISUM_LANES_INLINE Matrices turned_tops(Lanes along, Lanes across, Vectors a) {
  const Vectors s = (along - across) * a;
  const Lanes xy = s.x * a.y, yz = s.y * a.z, zx = s.z * a.x;
  return {{{s.x * a.x + across, xy, zx}, {xy, s.y * a.y + across, yz}, {zx, yz, s.z * a.z + across}}};
}

// Inertia of other bodies: R diag(moments) R^T.
VISUM_LANES_INLINE Matrices turned_others(const double (&moments)[3][4], const Matrices& R) {
  const Vectors a = load(moments[0]) * R.column[0], b = load(moments[1]) * R.column[1],
                c = load(moments[2]) * R.column[2];
  const auto& [u, v, w] = R.column;
  const Lanes xy = a.x * u.y + b.x * v.y + c.x * w.y, yz = a.y * u.z + b.y * v.z + c.y * w.z;
  const Lanes zx = a.z * u.x + b.z * v.x + c.z * w.x;
  return {{{a.x * u.x + b.x * v.x + c.x * w.x, xy, zx},
           {xy, a.y * u.y + b.y * v.y + c.y * w.y, yz},
           {zx, yz, a.z * u.z + b.z * v.z + c.z * w.z}}};
}

VISUM_LANES_INLINE Inertias inertias(const BodyArrays& of, const BodyBlock& block, const Matrices& R) {
  if (!block.top) return {turned_others(block.moments, R), turned_others(block.inverse_moments, R)};
  const Vectors axis = axes_of_tops(of, block);
  return {turned_tops(load(block.moments[2]), load(block.moments[0]), axis),
          turned_tops(load(block.inverse_moments[2]), load(block.inverse_moments[0]), axis)};
}

// Everything that follows from the links' orientations: orientation of the principal axes, its matrix,
// inertias in W.
VISUM_LANES_INLINE Inertias orient_block(const BodyArrays& of, const BodyBlock& block, Quaternions q_WB) {
  const Quaternions turn{load(block.q_BP[0]), load(block.q_BP[1]), load(block.q_BP[2]), load(block.q_BP[3])};
  const Quaternions q = block.aligned ? q_WB : q_WB * turn;
  const Matrices R = matrices(q);
  store_quaternions(Four{of.q, block.quaternion}, q);
  store_matrices(Four{of.R, block.matrix}, R);
  const Inertias inertia = inertias(of, block, R);
  store_matrices(Four{of.inertia, block.matrix}, inertia.of);
  store_matrices(Four{of.inverse_inertia, block.matrix}, inertia.inverse);
  return inertia;
}

void orient(const BodyArrays& of, const BodyBlock* blocks, std::size_t count) {
  for (const BodyBlock* block = blocks; block != blocks + count; ++block)
    orient_block(of, *block, load_quaternions(Four{of.q_WB, block->quaternion}));
}

// L = J w.
VISUM_LANES_INLINE Vectors momentum_of(const BodyArrays& of, const BodyBlock& block, Vectors w) {
  if (!block.top) return load_matrices(Four{of.inertia, block.matrix}) * w;
  const Vectors axis = axes_of_tops(of, block);
  const Lanes across = load(block.moments[0]);
  return across * w + ((load(block.moments[2]) - across) * dot(axis, w)) * axis;
}

// Makes the last flight the state. Returns whether any of the bodies has moved.
bool commit(const BodyArrays& of, const BodyBlock* blocks, std::size_t count, double h,
            const double* gravity) {
  const Vectors fall = h * everywhere(gravity);
  bool stand = true;
  for (const BodyBlock* block = blocks; block != blocks + count; ++block) {
    const Four<double> x{of.x, block->vector}, v{of.v, block->vector}, w{of.w, block->vector};
    const Four<double> q{of.q_WB, block->quaternion};
    const Vectors momentum = momentum_of(of, *block, load_vectors(w));
    const Vectors x1 = load_vectors(Four{of.x1, block->vector});
    Quaternions q1 = load_quaternions(Four{of.q1, block->quaternion});
    // From P's axes back to the link's.
    if (!block->aligned)
      q1 = renormalised(q1 * Quaternions{-load(block->q_BP[0]), -load(block->q_BP[1]), -load(block->q_BP[2]),
                                         load(block->q_BP[3])});
    stand = stand && is_all(same_bits(x1, load_vectors(x)) & same_bits(q1, load_quaternions(q)));
    store_vectors(x, x1);
    store_vectors(v, load_vectors(v) + fall);
    store_quaternions(q, q1);
    const Inertias inertia = orient_block(of, *block, q1);
    // The angular velocity follows from the momentum, in the new orientation.
    Vectors w1 = inertia.inverse * momentum;
    // With three different moments, what the rounded inverse has lost is given back. The momentum is thus
    // kept to rounding.
    if (!block->top) w1 = w1 + inertia.inverse * (momentum - inertia.of * w1);
    store_vectors(w, w1);
  }
  return !stand;
}

}  // namespace
}  // namespace visum::dynamics::impulse
