// The rotation exp(u): by the angle |u| about u.
#pragma once

#include <Eigen/Geometry>

#include "protocol/config/trig.h"

namespace visum::dynamics::impulse {

inline Eigen::Quaterniond rotation(const Eigen::Vector3d& u) {
  const double half = 0.5 * u.norm();
  const config::SinCos turn = config::sin_cos(half);
  // sin(a/2)/a, and its limit where a is 0.
  const double scale = half > 1e-8 ? 0.5 * turn.sin / half : 0.5;
  return {turn.cos, scale * u.x(), scale * u.y(), scale * u.z()};
}

}  // namespace visum::dynamics::impulse
