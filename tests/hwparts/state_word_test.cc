// The cause of every bit of the state word that a drive can set, and the command that clears it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

constexpr std::uint32_t kAllMotion =
    bit::kMotion | bit::kRampAcc | bit::kRampSteady | bit::kRampDec | bit::kRampEnd;

void expect_holds_until_commanded_anew(Rig& rig) {
  const double stood = rig.state().setpoint.position;
  rig.run(1.0);
  EXPECT_EQ(rig.state().setpoint.position, stood);
  rig.command.target = stood > 0.0 ? stood - 0.2 : stood + 0.2;
  rig.run(3.0);
  EXPECT_EQ(rig.state().setpoint.position, rig.command.target);
}

TEST(StateWord, RestingHomedDriveIsHomeOkAndRampEnd) {
  Rig rig(arm_drive(1));
  rig.run(0.5);
  EXPECT_EQ(rig.word(), bit::kHomeOk | bit::kRampEnd);
}

TEST(StateWord, RampBitsTellThePhase) {
  Rig rig(arm_drive(1));
  rig.command.target = 1.0;
  rig.run(0.1);
  EXPECT_EQ(rig.word() & kAllMotion, bit::kMotion | bit::kRampAcc);
  rig.run(1.0);
  EXPECT_EQ(rig.word() & kAllMotion, bit::kMotion | bit::kRampSteady);
  while (rig.has(bit::kRampSteady)) rig.tick();
  EXPECT_EQ(rig.word() & kAllMotion, bit::kMotion | bit::kRampDec);
  rig.run(1.0);
  EXPECT_EQ(rig.word() & kAllMotion, bit::kRampEnd);
}

TEST(StateWord, HaltStopsOnTheRampAndOnlyResetClearsIt) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.command.target = 2.0;
  rig.run(1.0);
  const double at = rig.state().setpoint.position, v = rig.state().setpoint.speed;
  rig.halt();
  rig.run(2.0);
  EXPECT_TRUE(rig.has(bit::kHalted | bit::kRampEnd));
  EXPECT_FALSE(rig.has(bit::kError));
  EXPECT_NEAR(rig.state().setpoint.position, at + v * v / (2.0 * data.limits.stop_deceleration), 1e-9);
  rig.command.target = 0.5;
  rig.run(1.0);
  EXPECT_TRUE(rig.has(bit::kHalted));
  EXPECT_EQ(rig.state().setpoint.speed, 0.0);
  rig.reset();
  EXPECT_FALSE(rig.has(bit::kHalted));
  expect_holds_until_commanded_anew(rig);
}

TEST(StateWord, TowErrorWhenTheAxisCannotFollow) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.plants[0].upper = 0.1;
  rig.command.target = 1.0;
  double error = 0.0;
  while (!rig.has(bit::kTowError) && rig.state().setpoint.position < 0.9) {
    error = std::abs(rig.state().setpoint.position - rig.state().measured_position);
    rig.tick();
  }
  EXPECT_TRUE(rig.has(bit::kError | bit::kTowError));
  EXPECT_NEAR(error, data.limits.following_error, data.limits.maximum_speed * rig.tick_s * 1.1);
  rig.run(1.0);
  EXPECT_EQ(rig.state().setpoint.speed, 0.0);
  rig.reset();
  EXPECT_FALSE(rig.has(bit::kError));
  EXPECT_FALSE(rig.has(bit::kTowError));
  rig.run(0.5);
  rig.command.target = -0.2;
  rig.run(3.0);
  EXPECT_EQ(rig.state().setpoint.position, -0.2);
  EXPECT_FALSE(rig.has(bit::kError));
}

TEST(StateWord, CommErrorStopsOnTheRampUntilReset) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.command.target = 2.0;
  rig.run(1.0);
  const double at = rig.state().setpoint.position, v = rig.state().setpoint.speed;
  rig.drive.lose_controller();
  rig.run(2.0);
  EXPECT_TRUE(rig.has(bit::kError | bit::kCommError | bit::kRampEnd));
  EXPECT_NEAR(rig.state().setpoint.position, at + v * v / (2.0 * data.limits.stop_deceleration), 1e-9);
  EXPECT_LT(std::abs(rig.plants[0].joint.velocity), 1e-3);
  rig.reset();
  EXPECT_EQ(rig.word() & (bit::kError | bit::kCommError), 0u);
  expect_holds_until_commanded_anew(rig);
}

TEST(StateWord, ATargetBeyondASoftLimitLeadsToTheLimitAndTripsThere) {
  auto data = arm_drive(2);
  Rig rig(data);
  rig.command.target = 2.5;
  rig.run(8.0);
  EXPECT_TRUE(rig.has(bit::kError | bit::kBeyondSoft));
  EXPECT_EQ(rig.state().setpoint.position, data.limits.soft_maximum);
  EXPECT_FALSE(rig.has(bit::kBeyondHard));
  rig.reset();
  EXPECT_EQ(rig.word() & (bit::kError | bit::kBeyondSoft), 0u);
  rig.run(0.5);
  rig.command.target = 2.4;  // further out again: it trips again at once
  rig.run(0.002);
  EXPECT_TRUE(rig.has(bit::kError | bit::kBeyondSoft));
  rig.reset();
  rig.command.target = 1.0;  // the way back is open
  rig.run(5.0);
  EXPECT_EQ(rig.state().setpoint.position, 1.0);
  EXPECT_FALSE(rig.has(bit::kError));
}

TEST(StateWord, StandingExactlyAtASoftLimitIsNoFault) {
  auto data = arm_drive(2);
  Rig rig(data);
  rig.plants[0].gravity = 60.0;
  rig.command.target = data.limits.soft_maximum;
  rig.run(10.0);
  EXPECT_EQ(rig.word(), bit::kHomeOk | bit::kRampEnd);
  EXPECT_NEAR(rig.state().measured_position, data.limits.soft_maximum, 1e-5);
}

TEST(StateWord, PushedBeyondASoftLimitOnlyTheWayBackIsOpen) {
  auto data = arm_drive(5);
  data.limits.following_error = 0.005;  // gives way early, so that it stands where it was pushed to
  Rig rig(data);
  rig.command.target = data.limits.soft_maximum - 0.02;
  rig.run(9.0);
  rig.plants[0].external = 55.0;  // more than the motor can hold
  while (!rig.has(bit::kBeyondSoft) && rig.position() < 3.0) rig.tick();
  EXPECT_GT(rig.state().measured_position, data.limits.soft_maximum);
  EXPECT_TRUE(rig.has(bit::kError));
  rig.plants[0].external = 20.0;
  rig.run(0.5);
  const double stood = rig.state().measured_position;
  ASSERT_GT(stood, data.limits.soft_maximum + data.limits.tolerance);
  ASSERT_FALSE(rig.has(bit::kBeyondHard));
  rig.drive.tune(&drive::Tuning::following_error, 0.1);
  rig.reset();
  EXPECT_FALSE(rig.has(bit::kError));
  EXPECT_TRUE(rig.has(bit::kBeyondSoft));  // still out there
  rig.command.target = stood + 0.01;
  rig.run(0.01);
  EXPECT_TRUE(rig.has(bit::kError));
  rig.reset();
  rig.command.target = 2.0;
  rig.run(4.0);
  EXPECT_EQ(rig.state().setpoint.position, 2.0);
  EXPECT_EQ(rig.word() & (bit::kError | bit::kBeyondSoft), 0u);  // went by itself on the way in
}

TEST(StateWord, BeyondAHardLimitTheLoopOpensAtOnce) {
  auto data = arm_drive(5);
  Rig rig(data, 0.001, data.limits.soft_maximum);
  rig.plants[0].external = 200.0;
  while (!rig.has(bit::kBeyondHard) && rig.position() < 4.0) rig.tick();
  EXPECT_TRUE(rig.has(bit::kError));
  EXPECT_EQ(rig.state().current, 0.0);
  EXPECT_LT(rig.state().measured_position, data.limits.hard_maximum + 0.05);
  rig.plants[0].external = 0.0;
  rig.run(1.0);
  EXPECT_TRUE(rig.has(bit::kBrakeActive));
  rig.reset();
  EXPECT_FALSE(rig.has(bit::kError));
  rig.run(0.2);
  EXPECT_FALSE(rig.has(bit::kBrakeActive));
  rig.command.target = rig.state().measured_position + 0.1;
  rig.run(0.01);
  EXPECT_TRUE(rig.has(bit::kError));
  rig.run(0.2);
  EXPECT_TRUE(rig.has(bit::kBrakeActive)) << "as the first time";
  rig.reset();
  rig.command.target = 2.0;
  rig.run(4.5);
  EXPECT_EQ(rig.state().setpoint.position, 2.0);
  EXPECT_EQ(rig.word(), bit::kHomeOk | bit::kRampEnd | (rig.word() & bit::kCurLimit));
}

TEST(StateWord, CurLimitIsAWarningThatResetClears) {
  Rig rig(arm_drive(5));
  rig.plants[0].external = 60.0;
  rig.run(0.05);
  EXPECT_TRUE(rig.has(bit::kCurLimit));
  rig.plants[0].external = 0.0;
  auto healed = rig.state();
  healed.latched &= ~(bit::kError | bit::kTowError);
  rig.put(healed);
  rig.run(2.0);
  EXPECT_TRUE(rig.has(bit::kCurLimit));
  rig.reset();
  EXPECT_FALSE(rig.has(bit::kCurLimit));
}

TEST(StateWord, LostSupplyFaultsBrakesAndKeepsThePosition) {
  Rig rig(arm_drive(2));
  rig.plants[0].gravity = 60.0;
  rig.command.target = 1.0;
  rig.run(5.0);
  rig.supply(0.0);
  rig.tick();
  EXPECT_TRUE(rig.has(bit::kError | bit::kPowerFault | bit::kPowVoltErr));
  EXPECT_EQ(rig.state().current, 0.0);
  EXPECT_FALSE(rig.has(bit::kBrakeActive));  // takes its engage time
  rig.run(0.05);
  EXPECT_TRUE(rig.has(bit::kBrakeActive));
  rig.run(5.0);
  EXPECT_NEAR(rig.position(), 1.0, 0.01);
  rig.reset();
  EXPECT_TRUE(rig.has(bit::kError | bit::kPowVoltErr));  // the cause is still there
  rig.supply(24.0);
  rig.run(0.1);
  EXPECT_TRUE(rig.has(bit::kError | bit::kPowVoltErr));  // latched
  rig.reset();
  rig.run(0.2);
  EXPECT_EQ(rig.word() & (bit::kError | bit::kPowerFault | bit::kPowVoltErr | bit::kBrakeActive), 0u);
  EXPECT_TRUE(rig.has(bit::kHomeOk));
  expect_holds_until_commanded_anew(rig);
}

TEST(StateWord, UndervoltageCountsAsLostSupply) {
  Rig rig(arm_drive(2));
  rig.supply(22.0);
  rig.run(0.01);
  EXPECT_FALSE(rig.has(bit::kError));
  rig.supply(21.99);
  rig.tick();
  EXPECT_TRUE(rig.has(bit::kPowVoltErr));
}

TEST(StateWord, IntegralErrWhenI2tIsUsedUpAndAPowerCycleAndResetClearIt) {
  auto data = arm_drive(1);
  data.limits.following_error = 10.0;
  Rig rig(data);
  rig.plants[0].upper = 0.1;
  rig.command.target = 1.0;
  while (rig.state().i2t == 0.0) rig.tick();
  double elapsed = 0.0;
  while (!rig.has(bit::kIntegralErr) && elapsed < 60.0) {
    rig.tick();
    elapsed += rig.tick_s;
  }
  EXPECT_NEAR(elapsed, data.motor.peak_time, 0.5);
  EXPECT_TRUE(rig.has(bit::kError | bit::kPowerFault));
  EXPECT_EQ(rig.state().current, 0.0);
  rig.run(60.0);  // cooled down, but only a power cycle tells the power stage so
  rig.reset();
  EXPECT_TRUE(rig.has(bit::kIntegralErr | bit::kError));
  rig.supply(0.0);
  rig.run(0.1);
  rig.supply(24.0);
  rig.run(0.1);
  EXPECT_TRUE(rig.has(bit::kIntegralErr));
  rig.reset();
  EXPECT_EQ(rig.word() & (bit::kError | bit::kPowerFault | bit::kIntegralErr | bit::kPowVoltErr), 0u);
}

TEST(StateWord, FetTempWhenTheWindingIsTooHotAndStaysUntilItCooled) {
  auto data = arm_drive(1);
  data.motor.nominal_current = data.motor.current_limit;  // heat only, no I²t
  data.motor.thermal_time = 20.0;
  Rig rig(data);
  rig.plants[0].external = -160.0;
  double before = 0.0;
  for (double t = 0.0; t < 120.0 && !rig.has(bit::kFetTemp); t += rig.tick_s) {
    before = rig.state().winding;
    rig.tick();
  }
  EXPECT_TRUE(rig.has(bit::kError | bit::kPowerFault | bit::kFetTemp | bit::kHomeOk));
  EXPECT_NEAR(before, data.motor.maximum_winding, 0.05);
  rig.plants[0].external = 0.0;
  rig.supply(0.0);
  rig.run(0.1);
  rig.supply(24.0);
  rig.run(0.1);
  rig.reset();
  EXPECT_TRUE(rig.has(bit::kFetTemp | bit::kError));  // still hot
  rig.run(20.0);
  rig.reset();
  EXPECT_EQ(rig.word() & (bit::kError | bit::kPowerFault | bit::kFetTemp), 0u);
}

TEST(StateWord, HomeDropsHomeOkMovesAndSetsItAtTheEnd) {
  auto data = arm_drive(1);
  Rig rig(data, 0.001, 0.5);
  rig.run(0.5);
  rig.drive.home();
  rig.run(0.3);
  EXPECT_FALSE(rig.has(bit::kHomeOk));
  EXPECT_TRUE(rig.has(bit::kMotion));
  EXPECT_LE(std::abs(rig.state().setpoint.speed), data.home.speed);
  rig.run(5.0);
  EXPECT_EQ(rig.state().setpoint.position, data.home.position);
  EXPECT_EQ(rig.word(), bit::kHomeOk | bit::kRampEnd);
  rig.run(2.0);  // the old target (0.5) does not draw it back
  EXPECT_EQ(rig.state().setpoint.position, data.home.position);
  rig.command.target = 0.3;
  rig.run(3.0);
  EXPECT_EQ(rig.state().setpoint.position, 0.3);
}

TEST(StateWord, HomingIsPossibleWhileHaltedButNotWithAFault) {
  Rig rig(arm_drive(1), 0.001, 0.2);
  rig.halt();
  rig.run(0.1);
  rig.drive.home();
  rig.run(5.0);
  EXPECT_TRUE(rig.has(bit::kHalted | bit::kHomeOk | bit::kRampEnd));
  EXPECT_EQ(rig.state().setpoint.position, 0.0);
  rig.drive.lose_controller();
  rig.drive.home();
  EXPECT_FALSE(rig.state().homing);
  EXPECT_TRUE(rig.has(bit::kHomeOk));
}

TEST(StateWord, HaltWhileHomingLeavesTheDriveUnhomed) {
  Rig rig(arm_drive(1), 0.001, 0.5);
  rig.drive.home();
  rig.run(0.5);
  rig.halt();
  rig.run(1.0);
  rig.reset();
  EXPECT_FALSE(rig.has(bit::kHomeOk));
  rig.command.target = 0.1;
  rig.run(1.0);
  EXPECT_EQ(rig.state().setpoint.speed, 0.0);
  EXPECT_NE(rig.state().setpoint.position, 0.1);
  rig.drive.home();
  rig.run(5.0);
  EXPECT_TRUE(rig.has(bit::kHomeOk));
}

TEST(StateWord, ResetInGoodHealthDisturbsNothing) {
  Rig rig(arm_drive(1));
  rig.command.target = 1.0;
  rig.run(0.5);
  rig.reset();
  rig.run(4.0);
  EXPECT_EQ(rig.state().setpoint.position, 1.0);
}

TEST(Drive, DisabledStopsOnTheRampAndGoesOnWhenEnabled) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.command.target = 1.0;
  rig.run(1.0);
  const double at = rig.state().setpoint.position, v = rig.state().setpoint.speed;
  rig.command.enabled = false;
  rig.run(1.0);
  EXPECT_NEAR(rig.state().setpoint.position, at + v * v / (2.0 * data.limits.stop_deceleration), 1e-9);
  EXPECT_EQ(rig.word(), bit::kHomeOk | bit::kRampEnd);
  rig.command.enabled = true;
  rig.run(4.0);
  EXPECT_EQ(rig.state().setpoint.position, 1.0);
}

}  // namespace
}  // namespace visum::test
