// Each fault of a drive against closed form: its effect on the axis, and the module's reaction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

drive::Broken with(auto drive::Broken::*member, auto value) {
  drive::Broken broken;
  broken.*member = value;
  return broken;
}

TEST(BrokenDrive, AStuckEncoderStandsAndTripsWhereTheSetpointIsTooFarAhead) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.run(0.2);
  const double stood = rig.state().measured_position;
  rig.drive.set_broken(with(&drive::Broken::encoder_stuck, true));
  rig.command.target = 1.0;
  double setpoint = 0.0;
  while (!rig.has(bit::kTowError) && setpoint < 0.9) {
    setpoint = rig.state().setpoint.position;
    rig.tick();
    ASSERT_EQ(rig.state().measured_position, stood);
  }
  EXPECT_TRUE(rig.has(bit::kError | bit::kTowError));
  EXPECT_NEAR(setpoint - stood, data.limits.following_error, data.limits.maximum_speed * rig.tick_s * 1.1);
  rig.run(1.0);
  EXPECT_NEAR(rig.state().measured_speed, 0.0, 1e-12);
  EXPECT_GT(rig.position(), 0.0) << "the axis went, though nobody counted";
  rig.drive.set_broken({});
  rig.tick();
  EXPECT_NEAR(rig.state().measured_position, rig.state().rotor_position, data.increment());
}

TEST(BrokenDrive, AnOffsetEncoderIsBelievedAndTheAxisStandsBesideItsPlace) {
  Rig rig(arm_drive(1));
  rig.drive.set_broken(with(&drive::Broken::encoder_offset, 0.01));  // less than the following error
  rig.command.target = 0.5;
  rig.run(6.0);
  EXPECT_NEAR(rig.state().measured_position, 0.5, 1e-4);
  EXPECT_NEAR(rig.position(), 0.49, 5e-4);
  EXPECT_FALSE(rig.has(bit::kError)) << "nothing tells";
}

TEST(BrokenDrive, LostTorqueNeedsSoMuchMoreCurrent) {
  auto data = arm_drive(2);
  const auto current = [&](double share) {
    Rig rig(data);
    rig.drive.set_broken(with(&drive::Broken::torque_share, share));
    rig.plants[0].external = -20.0;
    rig.run(8.0);
    EXPECT_NEAR(rig.state().gear_effort, 20.0, 0.05);
    return rig.state().current;
  };
  EXPECT_NEAR(current(0.5), 2.0 * current(1.0), 0.02 * current(1.0));
}

TEST(BrokenDrive, WithoutAnyTorqueTheAxisFallsAsIfFree) {
  auto data = ideal(arm_drive(1));
  Rig rig(data);
  rig.plants[0].external = 10.0;
  rig.drive.set_broken(with(&drive::Broken::torque_share, 0.0));
  rig.run(0.02);
  const double acceleration = 10.0 / (rig.plants[0].inertia + data.reflected_inertia());
  EXPECT_NEAR(rig.plants[0].joint.velocity, acceleration * 0.02, 1e-9);
}

TEST(BrokenDrive, AStuckBrakeHoldsAgainstTheMotorThoughTheModuleSaysThatItIsOpen) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.drive.set_broken(with(&drive::Broken::brake, drive::BrakeFault::kStuckClosed));
  rig.command.target = 1.0;
  while (!rig.has(bit::kError) && rig.state().setpoint.position < 0.9) {
    rig.tick();
    ASSERT_LT(std::abs(rig.state().rotor_speed), 1e-12);
  }
  EXPECT_TRUE(rig.has(bit::kTowError));
  EXPECT_FALSE(rig.has(bit::kBrakeActive));
  EXPECT_GT(rig.state().current, 0.0);
  EXPECT_LT(std::abs(rig.position()), data.gear.backlash);
}

TEST(BrokenDrive, AMotorThatIsStrongerThanItsStuckBrakeDragsItAlong) {
  auto data = ideal(arm_drive(1));
  data.gear.stiffness = 1e4;
  data.gear.damping = 50.0;
  data.brake.holding_effort = 5.0;
  Rig rig(data);
  rig.drive.set_broken(with(&drive::Broken::brake, drive::BrakeFault::kStuckClosed));
  rig.command.target = 2.0;
  rig.run(2.5);
  ASSERT_TRUE(rig.has(bit::kRampSteady));
  EXPECT_NEAR(rig.state().rotor_speed, data.limits.maximum_speed, 1e-3);
  double effort = 0.0;
  constexpr int kTicks = 500;
  for (int i = 0; i < kTicks; ++i) {
    rig.tick();
    effort += rig.state().current * data.effort_per_amp() / kTicks;
  }
  ASSERT_TRUE(rig.has(bit::kRampSteady));
  EXPECT_NEAR(effort, 5.0, 0.1) << "the friction of the brake";
}

TEST(BrokenDrive, ABrakeThatDoesNotCloseLetsTheAxisFallWhenThePowerGoes) {
  auto data = arm_drive(1);
  const auto fall = [&](drive::BrakeFault brake) {
    Rig rig(data);
    rig.drive.set_broken(with(&drive::Broken::brake, brake));
    rig.plants[0].external = 40.0;
    rig.run(0.5);
    rig.drive.open_loop();
    rig.run(1.0);
    EXPECT_TRUE(rig.has(bit::kBrakeActive)) << "so the module says";
    return rig.position();
  };
  EXPECT_LT(fall(drive::BrakeFault::kNone), 0.02);
  EXPECT_GT(fall(drive::BrakeFault::kStuckOpen), 0.1);
}

TEST(BrokenDrive, ASlippingGearCarriesItsLimitAndTheJointStaysBehindTheEncoder) {
  auto data = arm_drive(1);
  data.gear.backlash = 0.0;
  Rig rig(data);
  rig.plants[0].upper = 0.2;  // the joint is held there
  rig.run(0.1);
  rig.drive.set_broken(with(&drive::Broken::slip_effort, 8.0));
  rig.command.target = 0.5;
  double most = 0.0;
  for (int i = 0; i < 4000; ++i) {
    rig.tick();
    most = std::max(most, rig.state().gear_effort);
  }
  EXPECT_FALSE(rig.has(bit::kError)) << "the encoder got there";
  EXPECT_NEAR(rig.state().measured_position, 0.5, 1e-3);
  EXPECT_NEAR(most, 8.0, 1e-9) << "while the joint was held and the motor went on";
  EXPECT_NEAR(rig.position(), 0.2, 3e-3);  // the loop overshoots a little, and takes the joint back with it
  EXPECT_NEAR(rig.state().zero_offset, rig.state().measured_position - rig.position(), data.increment())
      << "what was lost in the gear";
}

TEST(BrokenDrive, HomeFindsThePlaceAnewThatAGearHasLost) {
  auto data = arm_drive(1);
  data.gear.backlash = 0.0;
  Rig rig(data);
  rig.plants[0].upper = 0.2;
  rig.drive.set_broken(with(&drive::Broken::slip_effort, 8.0));
  rig.command.target = 0.5;
  rig.run(4.0);
  rig.drive.set_broken({});
  rig.plants[0].upper = 1e9;
  rig.drive.home();
  rig.run(20.0);
  ASSERT_TRUE(rig.has(bit::kHomeOk));
  EXPECT_NEAR(rig.position(), data.home.position, 1e-3);
  EXPECT_NEAR(rig.state().measured_position, rig.position(), 1e-3);
}

TEST(BrokenDrive, AHotWindingTripsAndTheSupplyMustGoBeforeReset) {
  auto data = arm_drive(1);
  Rig rig(data);
  rig.run(0.1);
  rig.drive.set_broken(with(&drive::Broken::least_winding, data.motor.maximum_winding + 5.0));
  rig.tick();
  EXPECT_TRUE(rig.has(bit::kError | bit::kPowerFault | bit::kFetTemp));
  rig.drive.set_broken({});
  rig.run(0.1);
  rig.reset();
  EXPECT_TRUE(rig.has(bit::kFetTemp)) << "hot still, and not switched off";
  // It cools with its own time constant. Cooling by 15 K takes that constant times the ln of the ratio of the
  // temperatures above the surroundings.
  const double above = data.motor.maximum_winding + 5.0 - data.motor.ambient;
  const double cooled = data.motor.thermal_time * std::log(above / (above - 15.0));
  rig.run(0.9 * cooled - 0.1);
  EXPECT_GT(rig.state().winding, data.motor.maximum_winding - 10.0);
  rig.run(0.15 * cooled);
  EXPECT_LT(rig.state().winding, data.motor.maximum_winding - 10.0);
}

}  // namespace
}  // namespace visum::test
