// The arm's part: the contract of its ports, and the effect of its commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hwparts/kinds/part_kinds.h"
#include "hwparts/servo_group/part_state.h"
#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

using servo_group::PartState;
using testing::ElementsAreArray;
using testing::HasSubstr;

PartBench arm(const std::string& more = "", double tick_s = 0.001, double angle = 0.1) {
  return PartBench("amtec_arm", arm_context(tick_s, angle, 0.017, more));
}

std::vector<std::string> names(const std::vector<protocol::Port>& ports) {
  std::vector<std::string> all;
  for (const auto& port : ports) all.push_back(port.name + (port.unit.empty() ? "" : " [" + port.unit + "]"));
  return all;
}

// Saved panels and recorded vectors refer to this order, so it never changes.
TEST(AmtecArm, ControllerInputsAreThese) {
  const std::vector<std::string> expected{"Desired Angle 1 [rad]",
                                          "Desired Angle 2 [rad]",
                                          "Desired Angle 3 [rad]",
                                          "Desired Angle 4 [rad]",
                                          "Desired Angle 5 [rad]",
                                          "Desired Angle 6 [rad]",
                                          "Desired Angle 7 [rad]",
                                          "Maximum Speed 1 [rad/s]",
                                          "Maximum Speed 2 [rad/s]",
                                          "Maximum Speed 3 [rad/s]",
                                          "Maximum Speed 4 [rad/s]",
                                          "Maximum Speed 5 [rad/s]",
                                          "Maximum Speed 6 [rad/s]",
                                          "Maximum Speed 7 [rad/s]",
                                          "Desired Finger Position 1 [m]",
                                          "Desired Finger Position 2 [m]",
                                          "Maximum Finger Speed 1 [m/s]",
                                          "Maximum Finger Speed 2 [m/s]",
                                          "Reset",
                                          "Home",
                                          "Halt",
                                          "Execution Enable"};
  EXPECT_THAT(names(arm().part->description().controller_inputs), ElementsAreArray(expected));
}

TEST(AmtecArm, SensorOutputsAreThese) {
  std::vector<std::string> expected;
  const auto append = [&](const std::string& name, const std::string& unit, int count) {
    for (int i = 1; i <= count; ++i) expected.push_back(name + " " + std::to_string(i) + unit);
  };
  append("Actual Angle", " [rad]", 7);
  append("Actual Finger Position", " [m]", 2);
  append("Actual Speed", " [rad/s]", 7);
  append("Actual Finger Speed", " [m/s]", 2);
  append("Actual Current", " [A]", 9);
  append("Module State", "", 9);
  expected.push_back("Part State");
  expected.push_back("Changed");
  EXPECT_THAT(names(arm().part->description().sensor_outputs), ElementsAreArray(expected));
}

TEST(AmtecArm, StartsWithTheValuesThatKeepItWhereItIs) {
  auto bench = arm();
  EXPECT_EQ(bench.in("Desired Angle 3"), 0.1);
  EXPECT_EQ(bench.in("Maximum Speed 2"), 0.585);
  EXPECT_EQ(bench.in("Maximum Speed 6"), 0.475);
  EXPECT_EQ(bench.in("Desired Finger Position 2"), 0.017);
  EXPECT_EQ(bench.in("Maximum Finger Speed 1"), 0.041);
  EXPECT_EQ(bench.in("Execution Enable"), 1.0);
  EXPECT_NEAR(bench.out("Actual Angle 7"), 0.1, 1e-5);
  EXPECT_EQ(bench.module(9), bit::kHomeOk | bit::kRampEnd);
  EXPECT_EQ(bench.part_state(), static_cast<int>(PartState::kReady));
  const auto before = bench.outputs;
  bench.run(1.0);
  EXPECT_NEAR(bench.out("Actual Angle 3"), 0.1, 1e-4);
  EXPECT_EQ(bench.part_state(), static_cast<int>(PartState::kReady));
  EXPECT_EQ(before.size(), bench.outputs.size());
}

TEST(AmtecArm, RangesAreWiderThanTheDrivesLimitsAndHoldTheInitialValues) {
  const auto bench = arm();
  for (const auto& port : bench.part->description().controller_inputs) {
    EXPECT_LE(port.minimum, port.initial) << port.name;
    EXPECT_GE(port.maximum, port.initial) << port.name;
    EXPECT_TRUE(std::isfinite(port.minimum) && std::isfinite(port.maximum)) << port.name;
    if (port.group == "Desired Angle") {
      EXPECT_GT(port.maximum, 3.15) << port.name;
    }
    if (port.group == "Desired Finger Position") {
      EXPECT_GT(port.maximum, 0.036) << port.name;
    }
  }
}

TEST(AmtecArm, OneWrittenAngleMovesOneJoint) {
  auto bench = arm();
  bench.in("Desired Angle 4") = 0.5;
  bench.run(0.3);
  EXPECT_EQ(bench.part_state(), static_cast<int>(PartState::kMoving));
  bench.run(3.0);
  EXPECT_NEAR(bench.out("Actual Angle 4"), 0.5, 1e-5);
  EXPECT_NEAR(bench.out("Actual Angle 3"), 0.1, 1e-5);
  EXPECT_EQ(bench.part_state(), static_cast<int>(PartState::kReady));
}

TEST(AmtecArm, MaximumSpeedIsKept) {
  auto bench = arm();
  bench.in("Desired Angle 1") = 1.0;
  bench.in("Maximum Speed 1") = 0.1;
  bench.run(2.0);
  EXPECT_NEAR(bench.out("Actual Speed 1"), 0.1, 0.005);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.1 + 0.1 * 2.0, 0.02);
}

TEST(AmtecArm, ChangedCountsTheCycles) {
  auto bench = arm();
  bench.run(0.01);
  EXPECT_EQ(bench.out("Changed"), 10.0);
}

TEST(AmtecArm, UnequalFingerCommandsAreRefusedWithTheReason) {
  auto bench = arm();
  EXPECT_EQ(bench.part->refuse(bench.inputs), std::nullopt);
  bench.in("Desired Finger Position 1") = 0.02;
  EXPECT_THAT(bench.part->refuse(bench.inputs).value_or(""),
              HasSubstr("Desired Finger Position 1 and Desired Finger Position 2 must be equal"));
  bench.in("Desired Finger Position 2") = 0.02;
  EXPECT_EQ(bench.part->refuse(bench.inputs), std::nullopt);
  bench.in("Maximum Finger Speed 2") = 0.01;
  EXPECT_THAT(bench.part->refuse(bench.inputs).value_or(""), HasSubstr("one drive moves both"));
}

TEST(AmtecArm, CountersAndEnableTakeWholeNumbersOnly) {
  for (const char* name : {"Reset", "Home", "Halt", "Execution Enable"}) {
    auto bench = arm();
    bench.in(name) = 0.5;
    EXPECT_THAT(bench.part->refuse(bench.inputs).value_or(""), HasSubstr(name));
  }
}

TEST(AmtecArm, BothFingersAreTheOneModulesOpening) {
  auto bench = arm();
  bench.in("Desired Finger Position 1") = bench.in("Desired Finger Position 2") = 0.03;
  bench.run(3.0);
  EXPECT_NEAR(bench.plants[7].joint.position, 0.03, 2e-5);
  EXPECT_EQ(bench.plants[7].joint.position, bench.plants[8].joint.position);
  EXPECT_EQ(bench.out("Actual Finger Position 1"), bench.out("Actual Finger Position 2"));
  EXPECT_EQ(bench.out("Actual Current 8"), bench.out("Actual Current 9"));
  EXPECT_EQ(bench.module(8), bench.module(9));
}

// The grip that the loop's stiffness gives for a command inside of the object, less the way that play and
// torsion take, and limited by the current.
double grip_force(double inside) {
  const auto data = arm_drive(8);
  const double stiffness = data.loop.position_gain * data.loop.velocity_bandwidth * data.reflected_inertia();
  const double pressed = 2.0 * inside - 0.5 * data.gear.backlash;
  const double force = stiffness * pressed / (1.0 + stiffness / data.gear.stiffness);
  return std::min(force, data.effort_per_amp() * data.motor.current_limit);
}

TEST(AmtecArm, GripsWithABoundedForceForMinutesWithoutAFault) {
  for (const double inside : {0.001, 0.002, 0.003, 0.015}) {
    auto bench = arm();
    bench.plants[7].lower = bench.plants[8].lower = 0.015;  // an object of 30 mm
    bench.in("Desired Finger Position 1") = bench.in("Desired Finger Position 2") = 0.015 - inside;
    bench.run(3.0);
    const double force = -bench.plants[7].joint.effort;
    EXPECT_NEAR(force, grip_force(inside), 0.02 * force) << inside;
    EXPECT_NEAR(-bench.plants[8].joint.effort, force, 1e-9);
    bench.run(inside > 0.01 ? 180.0 : 1.0);
    EXPECT_NEAR(-bench.plants[7].joint.effort, force, 0.01 * force) << inside;
    EXPECT_EQ(bench.module(8) & ~bit::kCurLimit, bit::kHomeOk | bit::kRampEnd) << inside;
  }
}

TEST(AmtecArm, GripsAnObjectThatIsNotInTheMiddle) {
  auto bench = arm();
  bench.plants[7].lower = 0.016;
  bench.in("Desired Finger Position 1") = bench.in("Desired Finger Position 2") = 0.0155;
  bench.run(3.0);
  EXPECT_NEAR(bench.plants[7].joint.position, 0.016, 1e-9);
  EXPECT_LT(bench.plants[8].joint.position, 0.0161);
  EXPECT_GT(std::abs(bench.plants[7].joint.effort), 1.0);
  EXPECT_LT(std::abs(bench.plants[8].joint.effort), 0.5);  // nothing to press against
}

TEST(AmtecArm, KeepsItsGripThroughHaltResetAndALostController) {
  auto bench = arm();
  bench.plants[7].lower = bench.plants[8].lower = 0.015;
  bench.in("Desired Finger Position 1") = bench.in("Desired Finger Position 2") = 0.014;
  bench.run(3.0);
  const double force = bench.plants[7].joint.effort;
  bench.bump("Halt");
  bench.run(1.0);
  bench.bump("Reset");
  bench.run(1.0);
  bench.part->controller_lost();
  bench.run(1.0);
  bench.bump("Reset");
  bench.run(1.0);
  EXPECT_NEAR(bench.plants[7].joint.effort, force, 0.01 * std::abs(force));
}

TEST(AmtecArm, RefusesADrivesFileOfAnotherShape) {
  auto context = arm_context();
  context.joints.pop_back();
  context.joints.pop_back();
  try {
    hwparts::make_part("amtec_arm", context);
    FAIL();
  } catch (const config::ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("7 rotary drives"));
    EXPECT_THAT(error.what(), HasSubstr("servo_group"));
  }
}

TEST(AmtecArm, SaysWhatItIsOnTheBlackboardIdentity) {
  auto bench = arm();
  const auto& boards = bench.part->description().blackboards;
  ASSERT_EQ(boards.size(), 2u);
  EXPECT_EQ(boards[0].name, "Identity");
  EXPECT_FALSE(boards[0].writable);
  const auto bytes = bench.part->read_blackboard(0);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  EXPECT_EQ(text.size(), boards[0].elements);
  EXPECT_THAT(text, HasSubstr("kind: amtec_arm"));
  EXPECT_THAT(text, HasSubstr("module 8: PG70"));
  EXPECT_THAT(text, HasSubstr("Georgia Tech"));
  EXPECT_NE(bench.part->write_blackboard(0, 0, bytes), std::nullopt);
  EXPECT_TRUE(bench.part->read_blackboard(2).empty());
}

TEST(AmtecArm, FollowingErrorsAreCommandedMinusActualOfTheJoints) {
  auto bench = arm();
  bench.plants[1].external = -60.0;
  bench.run(4.0);
  std::vector<double> errors(9);
  bench.part->following_errors(errors);
  EXPECT_NEAR(errors[1], 0.1 - bench.plants[1].joint.position, 1e-12);
  EXPECT_GT(errors[1], 60.0 / 60000.0);  // the gear's torsion, which the encoder does not see
  EXPECT_LT(std::abs(errors[0]), 1e-4);
}

}  // namespace
}  // namespace visum::test
