// The commands and faults of a group of servos, tested with the arm's drives.
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
using testing::HasSubstr;

#define EXPECT_STATE(bench, expected) EXPECT_EQ((bench).part_state(), static_cast<int>(PartState::expected))

TEST(ControllerLost, StopsWithinTheBrakingDistanceAndLatchesTheFault) {
  auto bench = arm_bench();
  bench.set_angles(1.5);
  bench.run(1.5);
  std::vector<double> from, way;
  for (int i = 1; i <= 7; ++i) {
    from.push_back(bench.plants[static_cast<std::size_t>(i) - 1].joint.position);
    const double v = bench.out("Actual Speed " + std::to_string(i));
    way.push_back(v * v / (2.0 * arm_drive(i).limits.stop_deceleration));
    EXPECT_GT(v, 0.3);
  }
  bench.part->controller_lost();
  bench.tick();
  EXPECT_STATE(bench, kControllerLost);
  bench.run(1.0);
  for (int i = 1; i <= 7; ++i) {
    EXPECT_TRUE(bench.module(i) & bit::kError);
    EXPECT_TRUE(bench.module(i) & bit::kCommError);
    EXPECT_TRUE(bench.module(i) & bit::kRampEnd);
    const auto k = static_cast<std::size_t>(i) - 1;
    EXPECT_LT(std::abs(bench.plants[k].joint.position - from[k]), way[k] + 0.004) << i;
    EXPECT_LT(std::abs(bench.plants[k].joint.velocity), 1e-3) << i;
  }
}

TEST(ControllerLost, CommandsAreIgnoredUntilResetAndOldOnesAfterwardsToo) {
  auto bench = arm_bench();
  bench.set_angles(1.5);
  bench.run(1.0);
  bench.part->controller_lost();
  bench.run(1.0);
  const double stood = bench.out("Actual Angle 1");
  bench.set_angles(-1.0);
  bench.bump("Home");
  bench.run(1.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), stood, 1e-4);
  EXPECT_STATE(bench, kControllerLost);
  bench.bump("Reset");
  bench.in("Desired Angle 2") = 0.3;  // together with the Reset: does not count
  bench.run(2.0);
  EXPECT_STATE(bench, kReady);
  EXPECT_EQ(bench.module(1), bit::kHomeOk | bit::kRampEnd);
  EXPECT_NEAR(bench.out("Actual Angle 1"), stood, 1e-4);
  EXPECT_GT(bench.out("Actual Angle 2"), 0.4);
  bench.in("Desired Angle 1") = 0.5;  // anew: this joint moves, the others stand
  bench.run(4.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.5, 1e-4);
  EXPECT_GT(bench.out("Actual Angle 2"), 0.4);
}

TEST(ControllerLost, HoldLeavesTheLastValuesInForce) {
  auto bench = arm_bench(", on_controller_lost: hold");
  bench.set_angles(0.8);
  bench.run(0.5);
  bench.part->controller_lost();
  bench.run(4.0);
  EXPECT_STATE(bench, kReady);
  EXPECT_NEAR(bench.out("Actual Angle 5"), 0.8, 1e-4);
}

TEST(Counters, ActWhenTheNumberChangesAndOnlyThen) {
  auto bench = arm_bench();
  bench.in("Halt") = 7.0;
  bench.run(0.01);
  EXPECT_STATE(bench, kHalted);
  bench.in("Reset") = 3.0;
  bench.run(0.5);
  EXPECT_STATE(bench, kReady);  // Halt still says 7, but it has not changed
  bench.in("Halt") = 6.0;
  bench.run(0.01);
  EXPECT_STATE(bench, kHalted);
  bench.run(0.5);
  EXPECT_STATE(bench, kHalted);  // neither has Reset
}

TEST(Counters, ACounterWrittenBeforeTheFirstTickActsInIt) {
  auto bench = arm_bench();
  bench.in("Halt") = 1.0;
  bench.tick();
  EXPECT_STATE(bench, kHalted);
}

TEST(Halt, StopsAllAndAfterResetTheArmStandsUntilCommandedAnew) {
  auto bench = arm_bench();
  bench.set_angles(1.0);
  bench.run(1.0);
  bench.bump("Halt");
  bench.run(1.0);
  const double stood = bench.out("Actual Angle 3");
  EXPECT_STATE(bench, kHalted);
  bench.bump("Reset");
  bench.run(1.0);
  EXPECT_STATE(bench, kReady);
  EXPECT_NEAR(bench.out("Actual Angle 3"), stood, 1e-4);
  bench.set_angles(1.01);
  bench.run(4.0);
  EXPECT_NEAR(bench.out("Actual Angle 3"), 1.01, 1e-4);
}

TEST(Home, MovesAllDrivesHomeAndSaysSo) {
  auto bench = arm_bench();
  bench.bump("Home");
  bench.run(0.2);
  EXPECT_STATE(bench, kHoming);
  EXPECT_FALSE(bench.module(4) & bit::kHomeOk);
  bench.run(3.0);
  EXPECT_STATE(bench, kReady);
  EXPECT_NEAR(bench.out("Actual Angle 4"), 0.0, 1e-4);
  EXPECT_NEAR(bench.out("Actual Finger Position 1"), 0.017, 1e-4);
  EXPECT_TRUE(bench.module(4) & bit::kHomeOk);
}

TEST(Home, AnUnhomedGroupFollowsNothingBeforeIt) {
  auto bench = arm_bench(", homed: false");
  EXPECT_STATE(bench, kNotHomed);
  EXPECT_EQ(bench.module(1), bit::kRampEnd);
  bench.set_angles(0.5);
  bench.run(1.0);
  EXPECT_STATE(bench, kNotHomed);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.1, 1e-4);
  bench.bump("Home");
  bench.run(3.0);
  EXPECT_STATE(bench, kReady);
  bench.set_angles(0.4);
  bench.run(3.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.4, 1e-4);
}

TEST(ExecutionEnable, ZeroMeansNoMotionAndNoFault) {
  auto bench = arm_bench(", execution_enable: false");
  EXPECT_STATE(bench, kDisabled);
  EXPECT_EQ(bench.in("Execution Enable"), 0.0);
  bench.set_angles(0.5);
  bench.bump("Home");
  bench.run(1.0);
  EXPECT_STATE(bench, kDisabled);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.1, 1e-4);
  EXPECT_TRUE(bench.module(1) & bit::kHomeOk);
  bench.in("Execution Enable") = 1.0;
  bench.run(3.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.5, 1e-4);
  EXPECT_STATE(bench, kReady);
}

TEST(Fault, OfOneDriveStopsTheOthersWithoutAFaultOfTheirOwn) {
  auto bench = arm_bench();
  bench.set_angles(0.6);
  bench.in("Desired Angle 2") = -3.0;  // beyond its soft limit
  bench.in("Desired Angle 1") = 9.0;
  bench.run(3.5);
  EXPECT_STATE(bench, kMoving);
  bench.run(1.5);
  EXPECT_STATE(bench, kFault);
  EXPECT_TRUE(bench.module(2) & bit::kError);
  EXPECT_TRUE(bench.module(2) & bit::kBeyondSoft);
  EXPECT_EQ(bench.module(1), bit::kHomeOk | bit::kRampEnd);
  const double stood = bench.out("Actual Angle 1");
  bench.bump("Reset");
  bench.run(1.0);
  EXPECT_STATE(bench, kReady);
  EXPECT_NEAR(bench.out("Actual Angle 1"), stood, 1e-4);
  bench.in("Desired Angle 2") = 0.0;
  bench.run(6.0);
  EXPECT_NEAR(bench.out("Actual Angle 2"), 0.0, 1e-4);
}

TEST(Supply, OffAndOnAgainNeedsAReset) {
  auto bench = arm_bench();
  ASSERT_EQ(bench.part->set_parameter("Supply Voltage", 0.0), std::nullopt);
  bench.run(0.1);
  EXPECT_STATE(bench, kFault);
  for (int i = 1; i <= 9; ++i) EXPECT_TRUE(bench.module(i) & bit::kPowVoltErr) << i;
  EXPECT_TRUE(bench.module(1) & bit::kBrakeActive);
  bench.bump("Reset");
  bench.run(0.1);
  EXPECT_STATE(bench, kFault);
  ASSERT_EQ(bench.part->set_parameter("Supply Voltage", 24.0), std::nullopt);
  bench.bump("Reset");
  bench.run(0.5);
  EXPECT_STATE(bench, kReady);
}

// Reset acts before Home in the same tick, so the loop is closed when Home acts. The brake is still opening.
TEST(Home, WorksInTheTickOfTheResetThatGivesTheSupplyBack) {
  auto bench = arm_bench();
  ASSERT_EQ(bench.part->set_parameter("Supply Voltage", 0.0), std::nullopt);
  bench.run(0.5);
  ASSERT_EQ(bench.part->set_parameter("Supply Voltage", 24.0), std::nullopt);
  bench.bump("Reset");
  bench.bump("Home");
  bench.run(0.01);
  EXPECT_STATE(bench, kHoming);
  EXPECT_TRUE(bench.module(1) & bit::kBrakeActive);
  EXPECT_FALSE(bench.module(1) & (bit::kHomeOk | bit::kRampEnd));
  bench.run(4.0);
  EXPECT_STATE(bench, kReady);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.0, 1e-3);
}

// This must hold even where the Reset comes in the tick after the fault.
TEST(Fault, DuringHomeEndsItForTheOthersTooHoweverSoonResetComes) {
  auto bench = arm_bench();
  bench.bump("Home");
  bench.run(0.2);
  ASSERT_EQ(bench.part->set_parameter("Following Error Limit 3", 1e-5), std::nullopt);
  int ticks = 0;
  while (!(bench.module(3) & bit::kError) && ++ticks < 1000) bench.tick();
  ASSERT_TRUE(bench.module(3) & bit::kTowError);
  ASSERT_EQ(bench.part->set_parameter("Following Error Limit 3", 0.1), std::nullopt);
  bench.bump("Reset");
  bench.run(0.5);
  EXPECT_STATE(bench, kNotHomed);
  const double stood = bench.out("Actual Angle 1");
  EXPECT_GT(stood, 0.01);
  bench.run(1.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), stood, 1e-3);
}

TEST(Fault, OfADriveThatIsNotThereIsRefusedByItsNumber) {
  const auto bench = arm_bench();
  std::string why;
  const auto fault = hwparts::make_fault("encoder_stuck", {{"joint", 9}}, why);
  ASSERT_TRUE(fault) << why;
  EXPECT_EQ(bench.part->refuse_fault(*fault).value_or(""), "there is no drive 9; 'arm' has 8 drives")
      << "nine joints: the last two are one drive's";
}

TEST(ServoGroup, NumbersItsPortsInTheOrderOfTheDrivesFile) {
  auto context = arm_context();
  context.joints.erase(context.joints.begin() + 1, context.joints.begin() + 7);  // joint_1 and the fingers
  const auto part = hwparts::make_part("servo_group", context);
  std::vector<std::string> inputs, outputs;
  for (const auto& port : part->description().controller_inputs) inputs.push_back(port.name);
  for (const auto& port : part->description().sensor_outputs) outputs.push_back(port.name);
  EXPECT_THAT(inputs, testing::ElementsAre("Desired Angle 1", "Desired Position 2", "Desired Position 3",
                                           "Maximum Speed 1", "Maximum Speed 2", "Maximum Speed 3", "Reset",
                                           "Home", "Halt", "Execution Enable"));
  EXPECT_THAT(outputs,
              testing::ElementsAre("Actual Angle 1", "Actual Position 2", "Actual Position 3",
                                   "Actual Speed 1", "Actual Speed 2", "Actual Speed 3", "Actual Current 1",
                                   "Actual Current 2", "Actual Current 3", "Module State 1", "Module State 2",
                                   "Module State 3", "Part State", "Changed"));
}

TEST(ServoGroup, MovesASubsetOfTheJoints) {
  auto context = arm_context();
  context.joints.erase(context.joints.begin(), context.joints.begin() + 7);
  PartBench bench("servo_group", context);
  bench.in("Desired Position 1") = bench.in("Desired Position 2") = 0.03;
  bench.run(2.0);
  EXPECT_NEAR(bench.out("Actual Position 2"), 0.03, 2e-5);
}

TEST(ServoGroup, SaysItsStatesInWords) {
  auto bench = arm_bench();
  const auto& outputs = bench.part->description().sensor_outputs;
  const auto words = [&](const std::string& port) {
    const auto found = std::ranges::find(outputs, port, &protocol::Port::name);
    return found == outputs.end() ? "" : protocol::in_words(*found, bench.out(port));
  };
  bench.set_angles(1.5);
  bench.run(0.1);
  EXPECT_EQ(words("Part State"), "moving");
  EXPECT_EQ(words("Module State 1"), "HOME_OK MOTION RAMP_ACC");
  EXPECT_EQ(words("Actual Angle 1"), "");
  bench.part->controller_lost();
  bench.run(1.0);
  EXPECT_EQ(words("Part State"), "controller lost");
  EXPECT_EQ(words("Module State 1"), "ERROR HOME_OK COMM_ERROR RAMP_END");
}

TEST(ServoGroup, SaysABitWithoutANameByItsNumber) {
  const protocol::Port port{"p", "", 0, 4e9, 0, "p", {}, {{0, "ERROR"}}};
  EXPECT_EQ(protocol::in_words(port, 9), "ERROR bit 3");
  EXPECT_EQ(protocol::in_words(port, 0), "");
  EXPECT_EQ(protocol::in_words(port, 0.5), "");
  EXPECT_EQ(protocol::in_words(port, -1), "");
  EXPECT_EQ(protocol::in_words(port, std::nan("")), "");
}

TEST(PartKinds, AreListedAndAnUnknownOneNamesThem) {
  for (const auto& kind : hwparts::part_kinds()) {
    EXPECT_NE(std::string(kind.name), "");
    EXPECT_NE(std::string(kind.help), "");
  }
  const auto expect_refusal = [](const std::string& kind, const std::string& why) {
    try {
      hwparts::make_part(kind, arm_context());
      FAIL();
    } catch (const config::ConfigError& error) {
      EXPECT_THAT(error.what(), HasSubstr("there is no kind of part '" + kind + "'; " + why));
      EXPECT_THAT(error.what(), HasSubstr("scene:1: kind"));
    }
  };
  expect_refusal("toaster", "there are: amtec_arm, servo_group, ideal_joints");
  expect_refusal("amtec_arms", "did you mean 'amtec_arm'?");
}

}  // namespace
}  // namespace visum::test
