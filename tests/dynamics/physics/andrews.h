// Andrews' squeezing mechanism: seven bodies in a plane, ten hinges and a spring, driven by a constant torque
// from rest. It is fast (the crank turns at up to 1000 rad/s) and stiff. Data: Hairer and Wanner, Solving
// ODEs II, VI.9, and the test set for IVP solvers of the University of Bari. F is the end of the crank.
#pragma once

#include <vector>

#include "tests/dynamics/lab.h"

namespace visum::physics {

// The crank's hinge is "crank"; its drive gets the torque kAndrewsTorque as feedforward.
world::WorldModel andrews(const world::EngineSetting& engine, double tick_s);
inline constexpr double kAndrewsTorque = 0.033;  // N·m

struct AndrewsPoint {
  double time_s;
  Eigen::Vector3d f_W;
};
const std::vector<AndrewsPoint>& andrews_points();
inline constexpr double kAndrewsBetaAt_s = 0.03, kAndrewsBeta = 15.81077119629904;

Eigen::Vector3d andrews_f(const world::WorldModel& model, const world::WorldState& state);
double andrews_beta(const world::WorldState& state);

}  // namespace visum::physics
