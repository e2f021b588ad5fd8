// The walking controller: a trot in which diagonal legs swing together. In each cycle it takes the readings
// and gives each joint an angle, a speed and an effort, which the joint adds up by its stiffness and damping
// (mode impedance of `ideal_joints`). It knows no ports.
#pragma once

#include "clients/examples/quadruped/motion.h"

namespace visum::quadruped {

struct Commands {
  std::array<Vector3d, kLegs> angles, speeds, efforts;
};

inline constexpr double kSwing = 0.4;  // share of a stride that a leg is in the air

struct Course {
  double distance = 2.0;  // m, forward
  double speed = 0.4;     // m/s
};

class Walker {
 public:
  explicit Walker(const Course& course) : course_(course) {}

  Commands cycle(const Readings& now);
  bool done() const { return phase_ == Phase::kDone; }
  const Motion& motion() const { return motion_; }

 private:
  enum class Phase { kStand, kWalk, kBrake, kRest, kDone };

  bool steps() const;  // the feet take steps, and do not only stand
  Phase next_phase() const;
  void choose_speed();
  void step_feet();
  Vector3d landing(int leg) const;
  Vector3d in_trunk(int leg) const;
  Commands command(const Readings& now);

  Course course_;
  Motion motion_;
  Phase phase_ = Phase::kStand;
  double time_ = 0.0;                               // since the phase began
  double stride_ = kSwing;                          // 0 to 1: where in a stride the first pair of legs is
  double forward_ = 0.0, left_ = 0.0, turn_ = 0.0;  // the speeds that are wanted now
  std::array<bool, kLegs> stands_{true, true, true, true};
  std::array<Vector3d, kLegs> place_ = {},
                              lifted_ = {};  // of the feet in the level frame: now, at the last lift
  std::array<Vector3d, kLegs> last_angles_ = {};
  bool begun_ = false;
};

}  // namespace visum::quadruped
