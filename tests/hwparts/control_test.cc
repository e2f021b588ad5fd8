// The drives of the arm in closed loop: following, holding, stability over load and tick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

// The largest effort of gravity on the arm's joints, N·m: stretched out, with the gripper and 2 kg in it.
constexpr double kGravity[] = {0.0, 80.0, 30.0, 30.0, 5.0, 5.0, 1.0};

struct Range {
  double lowest = 1e9, highest = -1e9;
  void add(double x) {
    lowest = std::min(lowest, x);
    highest = std::max(highest, x);
  }
  double width() const { return highest - lowest; }
};

class Control : public testing::TestWithParam<std::tuple<int, double, double>> {
 protected:
  Rig make() const {
    const auto [number, inertia, tick] = GetParam();
    Rig rig(arm_drive(number), tick);
    rig.plants[0].inertia = inertia;
    // Limited for light loads: Euler's method cannot integrate a pendulum that is quicker than the tick.
    rig.plants[0].gravity = std::min(kGravity[number - 1], 300.0 * inertia);
    return rig;
  }
};

TEST_P(Control, FollowsAFullSpeedRampClosely) {
  Rig rig = make();
  rig.command.target = 1.5;
  double worst = 0.0;
  for (double t = 0.0; t < 6.0; t += rig.tick_s) {
    rig.tick();
    worst = std::max(worst, std::abs(rig.state().setpoint.position - rig.position()));
  }
  EXPECT_LT(worst, 0.02);
  EXPECT_EQ(rig.state().setpoint.position, 1.5);
  EXPECT_NEAR(rig.state().measured_position, 1.5, 1e-4);
  EXPECT_FALSE(rig.has(bit::kError));
}

TEST_P(Control, StandsStillUnderGravityWithoutALimitCycle) {
  Rig rig = make();
  rig.command.target = 1.5;
  rig.run(8.0);
  Range joint, rotor;
  for (int k = 0; k < 1000; ++k) {
    rig.tick();
    joint.add(rig.position());
    rotor.add(rig.state().rotor_position);
  }
  EXPECT_LT(rotor.width(), 1e-5);                   // a few increments of the encoder
  const bool loaded = rig.plants[0].gravity > 0.5;  // else the joint floats in the play
  EXPECT_LT(joint.width(), loaded ? 1e-5 : rig.drive.data().gear.backlash + 1e-5);
}

TEST_P(Control, CalmsDownAfterABlow) {
  Rig rig = make();
  rig.run(1.0);
  rig.plants[0].joint.velocity += 0.02 / std::max(0.1, rig.plants[0].inertia);
  rig.run(6.0);
  double worst = 0.0;
  for (int k = 0; k < 500; ++k) {
    rig.tick();
    worst = std::max(worst, std::abs(rig.state().rotor_speed));
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_NEAR(rig.state().rotor_position, 0.0, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(LoadsAndTicks, Control,
                         testing::Combine(testing::Range(1, 8), testing::Values(1e-4, 0.1, 1.0, 3.0, 10.0),
                                          testing::Values(0.001, 0.002, 0.004, 0.005)));

TEST(Drive, CurrentAtRestIsGravityOverTorqueConstantAndGear) {
  for (int number = 1; number <= 7; ++number) {
    auto data = arm_drive(number);
    Rig rig(data);
    rig.plants[0].gravity = 20.0;
    rig.command.target = 1.2;
    rig.run(8.0);
    double mean = 0.0;
    for (int k = 0; k < 2000; ++k) {
      rig.tick();
      mean += rig.state().current / 2000.0;
    }
    EXPECT_NEAR(mean, 20.0 * std::sin(rig.position()) / data.effort_per_amp(), 0.01) << number;
  }
}

TEST(Drive, CurrentWhileMovingCarriesFrictionToo) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.command.target = 2.5;
  rig.run(3.0);
  const double v = data.limits.maximum_speed;
  ASSERT_EQ(rig.state().setpoint.speed, v);
  const double friction = data.gear.viscous_friction * v + data.gear.coulomb_friction * std::tanh(v);
  double mean = 0.0;
  for (int k = 0; k < 1000; ++k) {
    rig.tick();
    mean += rig.state().current / 1000.0;
  }
  EXPECT_NEAR(mean, friction / data.effort_per_amp(), 0.05);
}

TEST(Drive, ReportsWholeIncrementsOfItsEncoder) {
  auto data = arm_drive(3);
  Rig rig(data);
  rig.command.target = 0.777;
  for (int k = 0; k < 3000; ++k) {
    rig.tick();
    const double count = rig.state().measured_position / data.increment();
    ASSERT_NEAR(count, std::round(count), 1e-6);
    ASSERT_LE(std::abs(rig.state().measured_position - rig.state().rotor_position),
              0.5001 * data.increment());
  }
}

TEST(Drive, MaximumSpeedIsTheDrivesOwnAtMost) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.command = {3.0, 100.0, true};
  for (int k = 0; k < 4000; ++k) {
    rig.tick();
    ASSERT_LE(std::abs(rig.state().setpoint.speed), data.limits.maximum_speed);
  }
}

TEST(Drive, IntegralDoesNotWindUpAtTheCurrentLimit) {
  auto data = arm_drive(1);
  data.limits.following_error = 10.0;
  Rig rig(data);
  rig.plants[0].upper = 0.2;  // runs into something
  rig.command.target = 1.0;
  rig.run(5.0);
  ASSERT_NEAR(rig.state().current, data.motor.current_limit, 1e-9);
  rig.command.target = 0.1;  // it lets go as soon as the setpoint is back, without first emptying an integral
  while (rig.state().setpoint.position > 0.2) rig.tick();
  rig.run(0.3);
  EXPECT_LT(rig.position(), 0.19);
  rig.run(3.0);
  EXPECT_NEAR(rig.state().measured_position, 0.1, 1e-5);
}

}  // namespace
}  // namespace visum::test
