// Where the trunk is and how it moves, from the IMU and the legs alone: the vertical, the heading, the speed
// over the ground and the way. It is called once in each cycle of kCycle.
#pragma once

#include "clients/examples/quadruped/leg.h"

namespace visum::quadruped {

inline constexpr double kCycle = 1e-3;  // s

// The readings of the robot's ports.
struct Readings {
  std::array<Vector3d, kLegs> angles, speeds;
  Vector3d rate = Vector3d::Zero();          // of the IMU's gyroscope, rad/s
  Vector3d acceleration = Vector3d::Zero();  // that it feels, m/s²: +9.81 upwards at rest
};

class Motion {
 public:
  // `stands[i]`: leg i is meant to stand. `at_rest`: the robot is known not to move, so that what the
  // gyroscope reads is its offset.
  void update(const Readings& now, const std::array<bool, kLegs>& stands, bool at_rest);

  const Vector3d& up() const { return up_; }              // in the trunk's frame
  const Vector3d& rate() const { return rate_; }          // without the gyroscope's offset
  double heading() const { return heading_; }             // turned to the left since the start
  const Vector3d& velocity() const { return velocity_; }  // of the trunk's origin, in its frame
  double way() const { return way_; }                     // forward since the start, m
  double drift() const { return drift_; }                 // to the left of the first heading

 private:
  Vector3d up_ = Vector3d::UnitZ(), rate_ = Vector3d::Zero(), offset_ = Vector3d::Zero();
  Vector3d velocity_ = Vector3d::Zero();
  double heading_ = 0.0, way_ = 0.0, drift_ = 0.0;
  int rests_ = 0;  // cycles at rest so far
};

}  // namespace visum::quadruped
