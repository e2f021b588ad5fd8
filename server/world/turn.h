// A rotation by an angle with the same bits on every processor. Eigen's own rotation takes its sines from the
// C library, which has other bits on other processors.
#pragma once

#include <Eigen/Geometry>

#include "protocol/config/trig.h"

namespace visum::world {

// `axis` must be of unit length.
inline Eigen::Quaterniond turn_about(const Eigen::Vector3d& axis, double angle_rad) {
  const config::SinCos half = config::sin_cos(0.5 * angle_rad);
  return {half.cos, half.sin * axis.x(), half.sin * axis.y(), half.sin * axis.z()};
}

}  // namespace visum::world
