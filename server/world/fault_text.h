// Small predicates and words shared by the checks of find_fault(). Private to server/world.
#pragma once

#include <cmath>
#include <string>

#include "server/world/world_model.h"

namespace visum::world {

// Nothing in a world may be larger: metres, m/s, rad/s (what is beyond has exploded or is a wrong unit).
inline constexpr double kMaxMagnitude = 1e6;
inline constexpr double kUnitTolerance = 1e-6;

inline bool is_in_range(double value, double low, double high) {
  return value >= low && value <= high;
}  // NaN: no

inline bool is_placed(const Eigen::Vector3d& p) {
  return (p.array().abs() <= kMaxMagnitude).all();
}  // NaN: no

inline bool is_unit(double norm) {
  return std::abs(norm - 1.0) <= kUnitTolerance;
}

inline std::string quoted(const std::string& name) {
  return "'" + name + "'";
}

// What is wrong with a pose, as the end of a sentence; empty if nothing.
inline std::string pose_fault(const Pose& pose) {
  if (!is_placed(pose.p)) return "has a position that is not finite or beyond 1e6 m";
  if (!is_unit(pose.q.norm())) return "has a quaternion that is not of unit length";
  return "";
}

std::string find_joint_fault(const WorldModel& model);
std::string find_shape_fault(const WorldModel& model);  // surfaces, meshes and shapes

}  // namespace visum::world
