// Checks of the numbers that clients send as places and velocities.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace visum::gateway {

inline constexpr double kFarthest = 1e6;  // m, m/s, rad/s, N
inline constexpr const char* kWrongPose =
    "pose needs x y z qw qx qy qz: none beyond 1e6, the quaternion of unit length";

inline bool is_list(const std::vector<double>& numbers, std::size_t count, bool may_be_absent) {
  return (may_be_absent && numbers.empty()) ||
         (numbers.size() == count &&
          std::ranges::all_of(numbers, [](double n) { return std::abs(n) <= kFarthest; }));
}

inline bool is_pose(const std::vector<double>& pose) {
  constexpr double kUnit = 1e-3;  // a quaternion's length may be off by so much
  if (!is_list(pose, 7, false)) return false;
  const Eigen::Vector4d q(pose[3], pose[4], pose[5], pose[6]);
  return std::abs(q.norm() - 1.0) <= kUnit;
}

}  // namespace visum::gateway
