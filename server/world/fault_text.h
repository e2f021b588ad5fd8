// Small predicates and texts that the checks of find_fault() share. Private to server/world. Comparisons are
// written so that NaN fails them.
#pragma once

#include <cmath>
#include <string>

#include "server/world/world_model.h"

namespace visum::world {

// The limit of all magnitudes in a world: m, m/s, rad/s. A number beyond it has exploded or is in a wrong
// unit.
inline constexpr double kMaxMagnitude = 1e6;
inline constexpr double kUnitTolerance = 1e-6;

inline bool is_in_range(double value, double low, double high) {
  return value >= low && value <= high;
}

// True if all components are within kMaxMagnitude.
inline bool is_placed(const Eigen::Vector3d& p) {
  return (p.array().abs() <= kMaxMagnitude).all();
}

inline bool is_unit(double norm) {
  return std::abs(norm - 1.0) <= kUnitTolerance;
}

inline std::string quoted(const std::string& name) {
  return "'" + name + "'";
}

// Says what is wrong with a pose, as the end of a sentence; empty: nothing.
inline std::string pose_fault(const Pose& pose) {
  if (!is_placed(pose.p)) return "has a position that is not finite or beyond 1e6 m";
  if (!is_unit(pose.q.norm())) return "has a quaternion that is not of unit length";
  return "";
}

// The parts of find_fault().
std::string find_joint_fault(const WorldModel& model);
std::string find_shape_fault(const WorldModel& model);  // surfaces, meshes and shapes

}  // namespace visum::world
