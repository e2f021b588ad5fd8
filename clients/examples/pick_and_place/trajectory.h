// A path through joint angles, and the time law along it. All joints start and stop together. They speed up
// evenly, run evenly and slow down evenly, and none passes its own maximum speed or acceleration.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace visum::pick_and_place {

// Joint angles to pass, with straight lines in joint space between them.
using JointPath = std::vector<Eigen::VectorXd>;

struct MotionLimits {
  Eigen::VectorXd speed;         // rad/s, > 0
  Eigen::VectorXd acceleration;  // rad/s², > 0; at bends of the path the change of direction comes on top
};

struct MotionState {
  Eigen::VectorXd position;  // rad
  Eigen::VectorXd velocity;  // rad/s
};

class Trajectory {
 public:
  Trajectory(JointPath path, const MotionLimits& limits);  // the path has at least one point

  double duration_s() const { return 2.0 * ramp_s_ + steady_s_; }
  MotionState at(double time_s) const;  // before the start: standing there; after the end: standing there

 private:
  // Progress along the path in seconds at full speed: at progress rate 1 the fastest joint runs at its
  // maximum.
  double progress(double time_s) const;
  double progress_rate(double time_s) const;

  JointPath path_;
  std::vector<double> progress_at_;  // of each point
  double acceleration_ = 0.0;        // of the progress, 1/s
  double ramp_s_ = 0.0;
  double steady_s_ = 0.0;
};

}  // namespace visum::pick_and_place
