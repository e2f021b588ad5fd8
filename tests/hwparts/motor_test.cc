#include "hwparts/drive/motor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hwparts/drive/friction.h"
#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

TEST(Motor, BackEmfTakesItsShareOfTheSupply) {
  auto data = arm_drive(1);
  const double no_load = 24.0 / (data.motor.torque_constant * data.gear.ratio);
  EXPECT_EQ(drive::current_window(data, 24.0, 0.0).upper, data.motor.current_limit);
  EXPECT_NEAR(drive::current_window(data, 24.0, no_load).upper, 0.0, 1e-12);
  EXPECT_TRUE(drive::current_window(data, 24.0, no_load).upper_by_voltage);
  EXPECT_EQ(drive::current_window(data, 24.0, no_load).lower, -data.motor.current_limit);
  const auto half = drive::current_window(data, 24.0, 0.9 * no_load);
  EXPECT_NEAR(half.upper, 0.1 * 24.0 / data.motor.resistance, 1e-9);
}

TEST(Motor, WindowStaysInsideTheLimitAtAnySpeedAndSupply) {
  const auto data = arm_drive(5);
  for (double speed = -50.0; speed <= 50.0; speed += 0.7) {
    for (const double supply : {0.0, 5.0, 24.0, 60.0}) {
      const auto window = drive::current_window(data, supply, speed);
      EXPECT_LE(window.lower, window.upper);
      EXPECT_LE(window.upper, data.motor.current_limit);
      EXPECT_GE(window.lower, -data.motor.current_limit);
    }
  }
}

TEST(Motor, WindingFollowsItsFirstOrderLaw) {
  const auto motor = arm_drive(1).motor;
  const double h = 0.001, current = 6.0;
  double winding = motor.ambient;
  for (int k = 0; k < 600'000; ++k) winding = drive::advance_winding(motor, winding, current, h);
  const double rise = current * current * motor.resistance * motor.thermal_resistance;
  EXPECT_NEAR(winding, motor.ambient + rise * (1.0 - std::exp(-600.0 / motor.thermal_time)), rise * 1e-5);
}

TEST(Motor, LimitCurrentFlowsForThePeakTimeAndNominalForEver) {
  const auto motor = arm_drive(1).motor;
  double i2t = 0.0;
  int ticks = 0;
  for (; i2t <= drive::i2t_budget(motor); ++ticks)
    i2t = drive::advance_i2t(motor, i2t, -motor.current_limit, 0.001);
  EXPECT_NEAR(ticks * 0.001, motor.peak_time, 0.0015);
  for (int k = 0; k < 1000; ++k) i2t = drive::advance_i2t(motor, i2t, 0.0, 0.1);
  EXPECT_EQ(i2t, 0.0);
  for (int k = 0; k < 1000; ++k) i2t = drive::advance_i2t(motor, i2t, motor.nominal_current, 1.0);
  EXPECT_EQ(i2t, 0.0);
}

TEST(Friction, IsWhatWasIdentifiedOnTheRealArm) {
  const double total[] = {72, 63, 77, 69, 26, 25, 29};  // N·m at 0.4 rad/s
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(drive::friction_effort(arm_drive(i + 1).gear, 0.4), total[i], 1.0);
}

TEST(Friction, SecantTimesSpeedIsTheFriction) {
  const auto gear = arm_drive(3).gear;
  for (const double speed : {-2.0, -1e-3, 1e-12, 0.4}) {
    EXPECT_NEAR(drive::friction_secant(gear, speed) * speed, drive::friction_effort(gear, speed), 1e-12);
  }
  EXPECT_EQ(drive::friction_secant(gear, 0.0),
            gear.viscous_friction + gear.coulomb_friction / gear.coulomb_speed);
}

TEST(Drive, TorqueIsNeverMoreThanTorqueConstantTimesGearTimesCurrentLimit) {
  for (int number = 1; number <= 8; ++number) {
    auto data = arm_drive(number);
    data.limits.following_error = 1e3;
    Rig rig(data, 0.001, data.linear ? 0.03 : 0.0);
    rig.plants[0].inertia = 1e6;  // as good as clamped: the gear carries the motor's whole effort
    rig.command.target = data.limits.soft_maximum;
    const double most = data.effort_per_amp() * data.motor.current_limit;
    double settled = 0.0;
    for (int k = 0; k < 6000; ++k) {
      rig.tick();
      EXPECT_LE(std::abs(rig.state().current), data.motor.current_limit);
      if (k >= 5000) settled = std::max(settled, std::abs(rig.state().gear_effort));
    }
    EXPECT_LE(settled, most * (1.0 + 1e-3)) << number;
    EXPECT_GT(settled, most * 0.5) << number;
  }
}

TEST(Drive, SpeedIsLimitedByWhatTheSupplyLeaves) {
  auto data = ideal(arm_drive(5));
  data.limits.maximum_speed = 100.0;
  data.limits.maximum_acceleration = 1e4;
  data.limits.following_error = 1e6;
  data.limits.limited = false;
  data.motor.nominal_current = data.motor.current_limit;
  Rig rig(data);
  rig.plants[0].inertia = 1.0;
  rig.command = {1e6, 100.0, true};
  rig.run(20.0);
  const double no_load = 24.0 / (data.motor.torque_constant * data.gear.ratio);
  EXPECT_NEAR(rig.plants[0].joint.velocity, no_load, 1e-3 * no_load);
}

TEST(Drive, FrictionStaysStableWhereItIsSteep) {
  auto data = ideal(arm_drive(1));
  data.gear.coulomb_friction = 80.0;
  data.gear.coulomb_speed = 1e-4;  // almost dry friction
  data.brake.present = false;
  Rig rig(data, 0.005);
  rig.plants[0].inertia = 0.01;
  rig.plants[0].joint.velocity = 0.4;
  auto running = rig.state();
  running.rotor_speed = 0.4;
  rig.put(running);
  rig.supply(0.0);  // runs out, without a motor
  double before = 0.4;
  for (int k = 0; k < 100; ++k) {
    rig.tick();
    EXPECT_GE(rig.state().rotor_speed, 0.0) << k;
    EXPECT_LE(rig.state().rotor_speed, before);
    before = rig.state().rotor_speed;
  }
  EXPECT_NEAR(before, 0.0, 1e-3);
}

}  // namespace
}  // namespace visum::test
