#include "server/dynamics/impulse/free_flight.h"

#include <cmath>

#include "protocol/config/trig.h"

namespace visum::dynamics::impulse {
namespace {

Quaterniond about(int axis, double angle) {
  const config::SinCos half = config::sin_cos(0.5 * angle);
  Quaterniond result(half.cos, 0.0, 0.0, 0.0);
  result.vec()[axis] = half.sin;
  return result;
}

Quaterniond fly_top(const BodyConstants& body, const Quaterniond& q, const Matrix3d& R, const Vector3d& w,
                    double h) {
  const int k = body.axis, other = (k + 1) % 3;
  const double across = body.moments[other], along = body.moments[k];
  const double spin = R.col(k).dot(w);  // w_3 = L_3/J3
  // L/J1 = w + (J3/J1 - 1) w_3 e_3, in W.
  const Vector3d precession = w + ((along / across - 1.0) * spin) * R.col(k);
  return rotation(h * precession) * (q * about(k, h * spin * (1.0 - along / across)));
}

// R <- R rot(angle about axis k), L <- rot(-angle) L.
template <int k>
inline void turn_about(double angle, Quaterniond& q, Vector3d& L) {
  constexpr int i = (k + 1) % 3, j = (k + 2) % 3;
  const config::SinCos half = config::sin_cos(0.5 * angle);
  // q times (cos, sin e_k).
  const Vector3d u = q.vec();
  const double scalar = q.w();
  q.w() = half.cos * scalar - half.sin * u[k];
  q.vec()[k] = half.cos * u[k] + half.sin * scalar;
  q.vec()[i] = half.cos * u[i] + half.sin * u[j];
  q.vec()[j] = half.cos * u[j] - half.sin * u[i];
  const config::SinCos full{2.0 * half.sin * half.cos, 1.0 - 2.0 * half.sin * half.sin};
  const double li = L[i];
  L[i] = full.cos * li + full.sin * L[j];
  L[j] = full.cos * L[j] - full.sin * li;
}

Quaterniond fly_any(const BodyConstants& body, Quaterniond q, const Matrix3d& R, const Vector3d& w,
                    double h) {
  Vector3d L = body.moments.cwiseProduct(R.transpose() * w);
  const Vector3d& inverse = body.inverse_moments;
  turn_about<0>(0.5 * h * L[0] * inverse[0], q, L);
  turn_about<1>(0.5 * h * L[1] * inverse[1], q, L);
  turn_about<2>(h * L[2] * inverse[2], q, L);
  turn_about<1>(0.5 * h * L[1] * inverse[1], q, L);
  turn_about<0>(0.5 * h * L[0] * inverse[0], q, L);
  return q;
}

}  // namespace

Quaterniond rotation(const Vector3d& u) {
  const double half = 0.5 * u.norm();
  const config::SinCos turn = config::sin_cos(half);
  // sin(a/2)/a, and its limit where a is nothing.
  const double scale = half > 1e-8 ? 0.5 * turn.sin / half : 0.5;
  return Quaterniond(turn.cos, scale * u.x(), scale * u.y(), scale * u.z());
}

Quaterniond fly(const BodyConstants& body, const Quaterniond& q, const Matrix3d& R, const Vector3d& w,
                double h) {
  switch (body.symmetry) {
    case Symmetry::kBall:
      return renormalised(rotation(h * w) * q);
    case Symmetry::kTop:
      return renormalised(fly_top(body, q, R, w, h));
    case Symmetry::kNone:
      break;
  }
  return renormalised(fly_any(body, q, R, w, h));
}

}  // namespace visum::dynamics::impulse
