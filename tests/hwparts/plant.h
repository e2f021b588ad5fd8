// The mechanics behind a drive in a test: an exact one-joint mechanism that follows the JointDrive law
// implicitly, as an engine does. q'' = (effort + external - m g l sin q) / inertia, semi-implicit Euler; or
// by the mean of the speeds at both ends of a tick, which is exact for constant efforts.
#pragma once

#include <algorithm>
#include <cmath>

#include "hwparts/joint.h"

namespace visum::test {

struct Plant {
  double inertia = 1.0;   // kg·m² or kg
  double gravity = 0.0;   // m g l, N·m; hangs at position 0
  double external = 0.0;  // constant effort from outside
  double lower = -1e9;    // hard stops: the plant cannot move beyond
  double upper = 1e9;
  bool by_mean_speed = false;
  hwparts::JointSample joint;

  void step(const hwparts::JointDrive& drive, double h) {
    const double load = external - gravity * std::sin(joint.position) + drive.feedforward;
    const double before = joint.velocity;
    const double free = before + h * load / inertia;  // without the drive's first term
    double effort = 0.0;
    if (drive.max_effort > 0.0) {  // (target - (free + h effort / inertia)) / compliance = effort
      effort = (drive.target_velocity - free) / (drive.compliance + h / inertia);
      effort = std::clamp(effort, -drive.max_effort, drive.max_effort);
    }
    joint.velocity = free + h * effort / inertia;
    joint.effort = effort + drive.feedforward;
    stop_at_limits(drive, h);
    joint.position += h * (by_mean_speed ? 0.5 * (before + joint.velocity) : joint.velocity);
  }

 private:
  // A stop sets the velocity at the tick's end, and the drive feels that velocity.
  void stop_at_limits(const hwparts::JointDrive& drive, double h) {
    const double next = joint.position + h * joint.velocity;
    const double held = std::clamp(next, lower, upper);
    if (held == next) return;
    joint.velocity = (held - joint.position) / h;
    double effort =
        drive.max_effort > 0.0 ? (drive.target_velocity - joint.velocity) / drive.compliance : 0.0;
    effort = std::clamp(effort, -drive.max_effort, drive.max_effort);
    joint.effort = effort + drive.feedforward;
  }
};

}  // namespace visum::test
