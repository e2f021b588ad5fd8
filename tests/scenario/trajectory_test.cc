// The law of time, against closed forms.
#include "clients/examples/pick_and_place/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

namespace visum::pick_and_place {
namespace {

Eigen::VectorXd pair(double a, double b) {
  return Eigen::Vector2d(a, b);
}

const MotionLimits kLimits{pair(0.5, 0.25), pair(1.0, 1.0)};

TEST(Trajectory, TakesDistanceOverSpeedPlusSpeedOverAcceleration) {
  // One joint alone: 2 rad at 0.5 rad/s and 1 rad/s².
  const Trajectory trajectory({pair(0, 0), pair(2, 0)}, {pair(0.5, 0.5), pair(1.0, 1.0)});
  EXPECT_NEAR(trajectory.duration_s(), 2.0 / 0.5 + 0.5 / 1.0, 1e-12);
  EXPECT_NEAR(trajectory.at(0.25).position[0], 0.5 * 0.25 * 0.25, 1e-12);
  EXPECT_NEAR(trajectory.at(0.25).velocity[0], 0.25, 1e-12);
}

TEST(Trajectory, ShortWayIsATriangle) {
  const Trajectory trajectory({pair(0, 0), pair(0.04, 0)}, {pair(0.5, 0.5), pair(1.0, 1.0)});
  EXPECT_NEAR(trajectory.duration_s(), 2.0 * std::sqrt(0.04), 1e-12);
  EXPECT_NEAR(trajectory.at(0.2).velocity[0], 0.2, 1e-12);
}

TEST(Trajectory, AllJointsArriveTogetherWithinTheirLimits) {
  const Trajectory trajectory({pair(0, 0), pair(1.0, -0.8), pair(1.2, -1.6)}, kLimits);
  Eigen::VectorXd before = trajectory.at(0.0).velocity;
  EXPECT_EQ(trajectory.at(0.0).position, pair(0, 0));
  for (double t = 0.0; t <= trajectory.duration_s(); t += 0.01) {
    const MotionState state = trajectory.at(t);
    EXPECT_LE(std::abs(state.velocity[0]), 0.5 + 1e-9);
    EXPECT_LE(std::abs(state.velocity[1]), 0.25 + 1e-9);
    before = state.velocity;
  }
  EXPECT_EQ(trajectory.at(trajectory.duration_s()).position, pair(1.2, -1.6));
  EXPECT_EQ(trajectory.at(trajectory.duration_s() + 1.0).velocity, pair(0, 0));
}

TEST(Trajectory, NeverAcceleratesMoreThanAllowedOnAStraightWay) {
  const Trajectory trajectory({pair(0, 0), pair(1.0, -0.8)}, kLimits);
  const double step = 0.001;
  for (double t = step; t <= trajectory.duration_s(); t += step) {
    const Eigen::VectorXd change = trajectory.at(t).velocity - trajectory.at(t - step).velocity;
    EXPECT_LE(change.cwiseAbs().maxCoeff() / step, 1.0 + 1e-9);
  }
}

TEST(Trajectory, VelocityIsTheDerivativeOfThePosition) {
  const Trajectory trajectory({pair(0, 0), pair(0.5, 0.1), pair(0.6, 0.5)}, kLimits);
  const double h = 1e-5;
  for (double t = 0.05; t < trajectory.duration_s() - 0.05; t += 0.0371) {
    const Eigen::VectorXd slope = (trajectory.at(t + h).position - trajectory.at(t - h).position) / (2 * h);
    EXPECT_NEAR((slope - trajectory.at(t).velocity).norm(), 0.0, 1e-3) << t;
  }
}

TEST(Trajectory, StandsWhereTheWayHasNoLength) {
  const Trajectory trajectory({pair(0.3, 0.4), pair(0.3, 0.4)}, kLimits);
  EXPECT_EQ(trajectory.duration_s(), 0.0);
  EXPECT_EQ(trajectory.at(0.0).position, pair(0.3, 0.4));
  EXPECT_EQ(Trajectory({pair(0.3, 0.4)}, kLimits).at(0.5).position, pair(0.3, 0.4));
}

}  // namespace
}  // namespace visum::pick_and_place
