// Vectors, quaternions and matrices of four bodies at once, loaded from and stored to each body's own place.
#pragma once

#include "protocol/config/trig.h"
#include "server/dynamics/impulse/lanes/lanes.h"

namespace visum::dynamics::impulse {
namespace {

struct Vectors {
  Lanes x, y, z;
};
struct Quaternions {
  Lanes x, y, z, w;
};
struct Matrices {
  Vectors column[3];
};

// Where the four bodies keep what is worked on: `base`, and an index for each.
template <typename Number>
struct Four {
  Number* base;
  const long (&index)[4];
};
template <typename Number>
Four(Number*, const long (&)[4]) -> Four<Number>;

template <typename Number>
VISUM_LANES_INLINE Four<Number> moved(Four<Number> at, int by) {
  return {at.base + by, at.index};
}

// One number of each of the four, two adjacent ones, and so on.
template <typename Number>
VISUM_LANES_INLINE Lanes load_one(Four<Number> at) {
  return lanes(at.base[at.index[0]], at.base[at.index[1]], at.base[at.index[2]], at.base[at.index[3]]);
}
VISUM_LANES_INLINE void store_one(Four<double> at, Lanes from) {
  at.base[at.index[0]] = low(from)[0];
  at.base[at.index[1]] = low(from)[1];
  at.base[at.index[2]] = high(from)[0];
  at.base[at.index[3]] = high(from)[1];
}
template <typename Number>
VISUM_LANES_INLINE void load_two(Four<Number> at, Lanes& a, Lanes& b) {
  const Lanes even = join(load_pair((at.base + at.index[0])), load_pair((at.base + at.index[2])));
  const Lanes odd = join(load_pair((at.base + at.index[1])), load_pair((at.base + at.index[3])));
  a = evens(even, odd);
  b = odds(even, odd);
}
VISUM_LANES_INLINE void store_two(Four<double> at, Lanes a, Lanes b) {
  const Lanes even = evens(a, b), odd = odds(a, b);
  store_pair((at.base + at.index[0]), low(even));
  store_pair((at.base + at.index[1]), low(odd));
  store_pair((at.base + at.index[2]), high(even));
  store_pair((at.base + at.index[3]), high(odd));
}
template <typename Number>
VISUM_LANES_INLINE Vectors load_vectors(Four<Number> at) {
  Vectors u;
  load_two(at, u.x, u.y);
  u.z = load_one(moved(at, 2));
  return u;
}
VISUM_LANES_INLINE void store_vectors(Four<double> at, Vectors u) {
  store_two(at, u.x, u.y);
  store_one(moved(at, 2), u.z);
}
template <typename Number>
VISUM_LANES_INLINE Quaternions load_quaternions(Four<Number> at) {
  Quaternions q;
  load_two(at, q.x, q.y);
  load_two(moved(at, 2), q.z, q.w);
  return q;
}
VISUM_LANES_INLINE void store_quaternions(Four<double> at, Quaternions q) {
  store_two(at, q.x, q.y);
  store_two(moved(at, 2), q.z, q.w);
}
template <typename Number>
VISUM_LANES_INLINE Matrices load_matrices(Four<Number> at) {
  Matrices m;
  load_two(at, m.column[0].x, m.column[0].y);
  load_two(moved(at, 2), m.column[0].z, m.column[1].x);
  load_two(moved(at, 4), m.column[1].y, m.column[1].z);
  load_two(moved(at, 6), m.column[2].x, m.column[2].y);
  m.column[2].z = load_one(moved(at, 8));
  return m;
}
VISUM_LANES_INLINE void store_matrices(Four<double> at, const Matrices& m) {
  store_two(at, m.column[0].x, m.column[0].y);
  store_two(moved(at, 2), m.column[0].z, m.column[1].x);
  store_two(moved(at, 4), m.column[1].y, m.column[1].z);
  store_two(moved(at, 6), m.column[2].x, m.column[2].y);
  store_one(moved(at, 8), m.column[2].z);
}

VISUM_LANES_INLINE Vectors operator+(Vectors a, Vectors b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
VISUM_LANES_INLINE Vectors operator-(Vectors a, Vectors b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
VISUM_LANES_INLINE Vectors operator-(Vectors a) {
  return {-a.x, -a.y, -a.z};
}
VISUM_LANES_INLINE Vectors operator*(Lanes s, Vectors a) {
  return {s * a.x, s * a.y, s * a.z};
}
VISUM_LANES_INLINE Vectors operator*(double s, Vectors a) {
  return all(s) * a;
}
VISUM_LANES_INLINE Lanes dot(Vectors a, Vectors b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
VISUM_LANES_INLINE Vectors cross(Vectors a, Vectors b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
VISUM_LANES_INLINE Vectors operator*(const Matrices& m, Vectors u) {
  return u.x * m.column[0] + u.y * m.column[1] + u.z * m.column[2];
}
VISUM_LANES_INLINE Mask same_bits(Vectors a, Vectors b) {
  return same_bits(a.x, b.x) & same_bits(a.y, b.y) & same_bits(a.z, b.z);
}
VISUM_LANES_INLINE Mask same_bits(Quaternions a, Quaternions b) {
  return same_bits(a.x, b.x) & same_bits(a.y, b.y) & same_bits(a.z, b.z) & same_bits(a.w, b.w);
}
VISUM_LANES_INLINE Vectors everywhere(const double* u) {
  return {all(u[0]), all(u[1]), all(u[2])};
}
// The largest of |x|, |y|, |z| and `so_far`, lane by lane. A NaN goes unnoticed.
VISUM_LANES_INLINE Lanes largest(Vectors u, Lanes so_far) {
  return larger(larger(magnitude(u.x), magnitude(u.y)), larger(magnitude(u.z), so_far));
}

VISUM_LANES_INLINE double largest_of(Lanes a) {
  double values[4], result = 0.0;
  store(values, a);
  for (const double value : values)
    if (value > result) result = value;
  return result;
}

VISUM_LANES_INLINE Quaternions operator*(Quaternions a, Quaternions b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
VISUM_LANES_INLINE Quaternions operator*(Lanes s, Quaternions q) {
  return {s * q.x, s * q.y, s * q.z, s * q.w};
}
// A product of unit quaternions, brought back to unit length by one step of Newton's square root.
VISUM_LANES_INLINE Quaternions renormalised(Quaternions q) {
  const Lanes square = (q.x * q.x + q.y * q.y) + (q.z * q.z + q.w * q.w);
  return (all(1.5) - all(0.5) * square) * q;
}
// The rotation matrices.
VISUM_LANES_INLINE Matrices matrices(Quaternions q) {
  const Lanes x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const Lanes wx = x2 * q.w, wy = y2 * q.w, wz = z2 * q.w;
  const Lanes xx = x2 * q.x, xy = y2 * q.x, xz = z2 * q.x;
  const Lanes yy = y2 * q.y, yz = z2 * q.y, zz = z2 * q.z;
  const Lanes one = all(1.0);
  return {{{one - (yy + zz), xy + wz, xz - wy},
           {xy - wz, one - (xx + zz), yz + wx},
           {xz + wy, yz - wx, one - (xx + yy)}}};
}

// sin(x)/x and cos(x) for |x| <= pi/4, as polynomials of z = x^2 (protocol/config/trig.h).
VISUM_LANES_INLINE Lanes sine_share(Lanes z) {
  const auto& S = config::kSine;
  const Lanes s =
      all(S[0]) + z * (all(S[1]) + z * (all(S[2]) + z * (all(S[3]) + z * (all(S[4]) + z * all(S[5])))));
  return all(1.0) + z * s;
}
VISUM_LANES_INLINE Lanes cosine(Lanes z) {
  const auto& C = config::kCosine;
  const Lanes c =
      all(C[0]) + z * (all(C[1]) + z * (all(C[2]) + z * (all(C[3]) + z * (all(C[4]) + z * all(C[5])))));
  return all(1.0) - (all(0.5) * z - z * z * c);
}

struct Turns {
  Lanes sin_share, cos;  // sin(x)/x, cos(x)
};
// The same for any x, from its square. Lanes with a larger x are computed one by one.
VISUM_LANES_INLINE Turns turns(Lanes z) {
  constexpr double kSmall = config::kQuarterPi * config::kQuarterPi;
  if (is_all(z <= all(kSmall))) [[likely]]
    return {sine_share(z), cosine(z)};
  double squares[4], shares[4], cosines[4];
  store(squares, z);
  store(shares, sine_share(z));
  store(cosines, cosine(z));
  for (int i = 0; i < 4; ++i) {
    if (squares[i] <= kSmall) continue;
    const double x = __builtin_sqrt(squares[i]);
    const config::SinCos of = config::sin_cos_large(x);
    shares[i] = x > 1e-8 ? of.sin / x : 1.0;
    cosines[i] = of.cos;
  }
  return {load(shares), load(cosines)};
}

// exp(u): the rotation by the angle |u| about u.
VISUM_LANES_INLINE Quaternions rotations(Vectors u) {
  const Turns turn = turns(all(0.25) * dot(u, u));
  const Vectors v = (all(0.5) * turn.sin_share) * u;
  return {v.x, v.y, v.z, turn.cos};
}

}  // namespace
}  // namespace visum::dynamics::impulse
