// A part in front of real modules: its behaviour when bus or modules are not as they should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hwparts/kinds/part_kinds.h"
#include "hwparts/servo_group/part_state.h"
#include "tests/hwparts/real_bench.h"

namespace visum::test {
namespace {

using powercube::BusFraming;
using powercube::Message;
using servo_group::PartState;
using testing::AllOf;
using testing::HasSubstr;
namespace command = powercube::command;

std::string refusal(const std::string& behind, const std::string& front, auto prepare) {
  PartBench modules("amtec_arm", arm_context(0.001, 0.1, 0.017, further(behind)));
  PluggedConnection* line = nullptr;
  PluggedConnection plugged(
      *modules.part, BusFraming::kSerial,
      [&] {
        modules.tick();
        line->pass_tick();
      },
      0.001);
  line = &plugged;
  EXPECT_EQ(modules.part->set_parameter("Maximum Acceleration 4", 1.0), std::nullopt);
  prepare(modules, plugged);
  try {
    hwparts::make_real_part("amtec_arm", arm_context(0.001, 0.0, 0.0, further(front)), plugged, {});
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

void nothing(PartBench&, PluggedConnection&) {}

TEST(Survey, NamesModulesThatDoNotAnswerAndThoseThatDo) {
  const auto text = refusal("", "", [](PartBench&, PluggedConnection& line) { line.silent = {3, 8}; });
  EXPECT_THAT(text,
              AllOf(HasSubstr("plugged is not the bus of this part"), HasSubstr("module 3 does not answer"),
                    HasSubstr("module 8 does not answer"), HasSubstr("1, 2, 4, 5, 6, 7\n")));
}

TEST(Survey, RefusesAnotherSerialNumberThanTheConfigurations) {
  EXPECT_EQ(refusal("modules: {each: {8: {serial_number: 20278}}}",
                    "modules: {each: {8: {serial_number: 20278}}}", nothing),
            "");
  EXPECT_THAT(refusal("", "modules: {each: {8: {serial_number: 20278}}}", nothing),
              HasSubstr("module 8 has the serial number 40008, not 20278"));
}

TEST(Survey, RefusesAModuleOfAnotherKind) {
  EXPECT_THAT(refusal("modules: {each: {2: {config: 0x20108}}}", "", nothing),
              HasSubstr("module 2 is linear, the configuration has a rotary drive there"));
}

TEST(Survey, RefusesAModuleThatMoves) {
  const auto text = refusal("", "", [](PartBench& modules, PluggedConnection&) {
    modules.in("Desired Angle 5") = 2.0;
    modules.run(0.5);
  });
  EXPECT_THAT(text, HasSubstr("module 5 is moving"));
}

TEST(Survey, RefusesAModuleThatDoesNotTakeItsLimits) {
  const auto text = refusal("", "", [](PartBench&, PluggedConnection& line) { line.deaf_to = 0x4A; });
  EXPECT_THAT(text, HasSubstr("module 4 does not take 2.232 as its maximum acceleration and keeps 1"));
}

TEST(Survey, TakesModulesThatAreNotHomedAndCountFromWhereTheyWereSwitchedOn) {
  EXPECT_EQ(refusal("homed: false, modules: {counts_from_zero: true}", "homed: false", nothing), "");
}

TEST(Survey, SurvivesLostRequests) {
  EXPECT_EQ(refusal("", "", [](PartBench&, PluggedConnection& line) { line.lose_next = 2; }), "");
}

TEST(BusGroup, SendsNoMotionWithoutExecutionEnable) {
  RealBench arm(BusFraming::kSerial, "", "", {});
  EXPECT_EQ(arm.part->description().controller_inputs.back().initial, 0.0);
  arm.line.sent.clear();
  for (std::size_t i = 0; i < 7; ++i) arm.inputs[i] = 1.0;
  const auto home = arm.inputs.size() - 3;
  arm.inputs[home] += 1.0;
  arm.run(0.5);
  EXPECT_EQ(arm.line.count(command::kSetMove), 0);
  EXPECT_EQ(arm.line.count(command::kHome), 0);
  EXPECT_GT(arm.line.count(command::kGetParameter), 100);
  arm.inputs.back() = 1.0;
  arm.run(0.1);
  EXPECT_EQ(arm.line.count(command::kSetMove), 7);
}

struct Ends {
  RealBench& arm;
  PartState state() const {
    return static_cast<PartState>(static_cast<int>(arm.outputs[arm.outputs.size() - 2]));
  }
  std::uint32_t module(std::size_t i) const {
    return static_cast<std::uint32_t>(arm.outputs[arm.outputs.size() - 2 - 9 + i - 1]);
  }
  void reset() { arm.inputs[arm.inputs.size() - 4] += 1.0; }
};

TEST(BusGroup, ARequestThatIsLostIsRepeated) {
  RealBench arm;
  arm.line.lose_next = 1;
  arm.inputs[0] = 0.2;
  arm.run(2.0);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, 0.2, 2e-3);
  EXPECT_EQ(Ends{arm}.state(), PartState::kReady);
}

TEST(BusGroup, AModuleThatFallsSilentStopsTheOthers) {
  RealBench arm;
  for (std::size_t i = 0; i < 7; ++i) arm.inputs[i] = 1.5;
  arm.run(0.8);
  arm.line.silent = {4};
  arm.run(1.2);
  const Ends ends{arm};
  EXPECT_EQ(ends.state(), PartState::kFault);
  EXPECT_EQ(ends.module(4) & (bit::kError | bit::kCommError), bit::kError | bit::kCommError);
  EXPECT_FALSE(ends.module(1) & bit::kError);
  const double stood = arm.behind.plants[0].joint.position;
  EXPECT_LT(stood, 1.0);
  arm.run(0.3);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, stood, 1e-3);
}

TEST(BusGroup, APulledCableIsAFaultAndAPluggedOneHaltsTheArm) {
  RealBench arm;
  Ends ends{arm};
  for (std::size_t i = 0; i < 7; ++i) arm.inputs[i] = 1.5;
  arm.run(0.8);
  arm.line.cut = true;
  arm.run(1.5);
  EXPECT_EQ(ends.state(), PartState::kFault);
  arm.line.cut = false;
  arm.run(1.0);
  const double stood = arm.behind.plants[0].joint.position;
  arm.run(0.5);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, stood, 1e-3) << "it stands as soon as it can be told to";
  EXPECT_EQ(ends.state(), PartState::kFault) << "until Reset";
  ends.reset();
  arm.run(0.5);
  EXPECT_EQ(ends.state(), PartState::kReady);
  arm.run(0.3);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, stood, 1e-3);
  arm.inputs[0] = 0.0;
  arm.run(4.0);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, 0.0, 2e-3);
}

TEST(BusGroup, ADeviceThatIsGoneIsAFaultAtOnce) {
  RealBench arm;
  Ends ends{arm};
  arm.line.gone = true;
  arm.run(0.003);
  EXPECT_EQ(ends.state(), PartState::kFault);
  for (std::size_t i = 1; i <= 9; ++i) EXPECT_TRUE(ends.module(i) & bit::kCommError) << i;
  arm.line.gone = false;
  arm.run(1.0);
  ends.reset();
  arm.run(0.2);
  EXPECT_EQ(ends.state(), PartState::kReady);
}

TEST(BusGroup, AResetWhileTheCableIsOutTakesNothingBack) {
  RealBench arm;
  Ends ends{arm};
  arm.line.cut = true;
  arm.run(1.5);
  ends.reset();
  arm.run(0.5);
  EXPECT_EQ(ends.state(), PartState::kFault);
  EXPECT_TRUE(ends.module(1) & bit::kCommError);
}

TEST(BusGroup, LimitsAreSentAgainToAModuleThatWasAway) {
  RealBench arm;
  Ends ends{arm};
  ASSERT_EQ(arm.part->set_parameter("Maximum Acceleration 4", 0.5), std::nullopt);
  arm.run(0.1);
  arm.line.silent = {4};
  arm.run(1.0);
  ASSERT_EQ(arm.behind.part->set_parameter("Maximum Acceleration 4", 2.0), std::nullopt);  // its own again
  arm.line.silent = {};
  arm.run(1.0);
  ends.reset();
  arm.run(0.2);
  for (const auto& parameter : arm.behind.part->parameters()) {
    if (parameter.name == "Maximum Acceleration 4") {
      EXPECT_NEAR(std::get<double>(parameter.value), 0.5, 1e-6);
    }
  }
}

TEST(BusGroup, TheWatchdogIsArmedAgainInAModuleThatWasAway) {
  RealBench arm(BusFraming::kSerial, "", "", {true, true});
  arm.line.silent = {4};
  arm.run(1.0);
  arm.line.silent = {};
  arm.run(1.0);
  arm.line.sent.clear();
  Ends{arm}.reset();
  arm.run(0.2);
  constexpr std::uint8_t kConfig = 0x39;
  const auto armed = std::ranges::find_if(arm.line.sent, [](const powercube::Telegram& telegram) {
    return telegram.module == 4 && telegram.message.command() == command::kSetParameter &&
           telegram.message.data[1] == kConfig;
  });
  ASSERT_NE(armed, arm.line.sent.end());
  EXPECT_TRUE(powercube::value_at<std::uint32_t>(armed->message, 2) & powercube::config_bit::kWatchdogEnable);
}

TEST(BusGroup, ServesTheWatchdogAndWithoutItTheModulesStop) {
  hwparts::RealOptions options{true, true};
  RealBench arm(BusFraming::kSerial, "", "", options);
  arm.inputs[0] = 1.5;
  arm.run(0.8);
  EXPECT_EQ(Ends{arm}.state(), PartState::kMoving);
  EXPECT_GT(arm.line.count(command::kWatchdog), 10);
  arm.behind.run(1.0);  // no life signs come any more
  EXPECT_TRUE(arm.behind.module(1) & bit::kCommError);
}

TEST(BusGroup, LeavesNothingMovingBehind) {
  RealBench arm;
  arm.inputs[0] = 1.5;
  arm.run(0.8);
  arm.part->stand_down();
  arm.behind.run(1.0);
  EXPECT_TRUE(arm.behind.module(1) & bit::kHalted);
  EXPECT_NEAR(arm.behind.plants[0].joint.velocity, 0.0, 1e-3);
}

// No reading has shown the motion yet.
TEST(BusGroup, LeavesNothingMovingBehindThatHasJustBegun) {
  RealBench arm;
  arm.inputs[0] = 1.5;
  arm.part->act(arm.inputs, {}, {});
  while (arm.line.count(command::kSetMove) == 0) arm.part->pump();
  arm.part->stand_down();
  arm.behind.run(1.0);
  EXPECT_TRUE(arm.behind.module(1) & bit::kHalted);
  EXPECT_NEAR(arm.behind.plants[0].joint.velocity, 0.0, 1e-3);
  EXPECT_LT(arm.behind.plants[0].joint.position, 0.2);
}

TEST(BusGroup, LeavesNothingOnItsWayHome) {
  RealBench arm;
  arm.inputs[arm.inputs.size() - 3] += 1.0;
  arm.part->act(arm.inputs, {}, {});
  while (arm.line.count(command::kHome) < 8) arm.part->pump();
  arm.part->stand_down();
  arm.behind.run(1.0);
  for (int id = 1; id <= 8; ++id) EXPECT_TRUE(arm.behind.module(id) & bit::kHalted) << id;
  EXPECT_NEAR(arm.behind.plants[0].joint.position, 0.1, 2e-3);
}

TEST(BusGroup, AModuleThatFallsSilentStopsTheOthersOnTheirWayHome) {
  RealBench arm;
  arm.inputs[arm.inputs.size() - 3] += 1.0;
  arm.run(0.1);
  EXPECT_EQ(Ends{arm}.state(), PartState::kHoming);
  arm.line.silent = {4};
  arm.run(0.5);
  EXPECT_EQ(Ends{arm}.state(), PartState::kFault);
  const double stood = arm.behind.plants[0].joint.position;
  EXPECT_GT(stood, 0.005) << "it was not home yet";
  arm.run(0.5);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, stood, 1e-3);
  EXPECT_TRUE(arm.behind.module(1) & bit::kHalted);
}

// HALT never waits behind other requests, and requests that follow it do not undo it.
TEST(BusGroup, AHaltGoesBeforeAResetThatStillWaitsAndBehindItAgain) {
  RealBench arm;
  arm.line.sent.clear();
  Ends{arm}.reset();
  arm.inputs[arm.inputs.size() - 2] += 1.0;
  arm.run(0.2);
  std::vector<std::uint8_t> said;
  for (const auto& telegram : arm.line.sent)
    if (telegram.module == 3 && telegram.message.command() != command::kGetParameter)
      said.push_back(telegram.message.command());
  EXPECT_THAT(said, testing::ElementsAre(command::kHalt, command::kReset, command::kHalt));
}

// A RESET leaves the ramp of a module without a fault running, so the part must remember the ramp.
TEST(BusGroup, AResetDuringAMotionLeavesItToBeStopped) {
  for (const bool at_once : {true, false}) {
    for (const auto framing : {BusFraming::kSerial, BusFraming::kCan}) {
      RealBench arm(framing);
      arm.inputs[0] = 1.5;
      arm.run(0.8);
      Ends{arm}.reset();
      if (!at_once) {
        arm.part->act(arm.inputs, {}, {});
        ASSERT_EQ(arm.line.sent.back().message, Message{command::kReset});
      }
      arm.inputs.back() = 0.0;
      arm.run(0.8);
      EXPECT_NEAR(arm.behind.plants[0].joint.velocity, 0.0, 1e-3) << at_once;
      EXPECT_LT(arm.behind.plants[0].joint.position, 0.6) << at_once;
      arm.inputs.back() = 1.0;
      arm.run(4.0);
      EXPECT_NEAR(arm.behind.plants[0].joint.position, 1.5, 2e-3) << at_once;
    }
  }
}

TEST(BusGroup, AResetInGoodHealthDisturbsNoMotion) {
  RealBench arm;
  arm.inputs[0] = 1.5;
  arm.run(1.2);
  Ends{arm}.reset();
  for (int i = 0; i < 300; ++i) {
    arm.tick();
    ASSERT_GT(arm.behind.plants[0].joint.velocity, 0.3) << i;
  }
}

// ---- refusals of a module ----

TEST(BusGroup, ARefusedMotionIsAskedForAgain) {
  for (const auto framing : {BusFraming::kSerial, BusFraming::kCan}) {
    RealBench arm(framing);
    arm.line.refuse_moves = 3;
    arm.inputs[0] = 0.2;
    arm.run(2.0);
    EXPECT_NEAR(arm.behind.plants[0].joint.position, 0.2, 2e-3);
    EXPECT_EQ(Ends{arm}.state(), PartState::kReady);
    EXPECT_EQ(arm.line.count(command::kSetMove), 4);
  }
}

TEST(BusGroup, AModuleThatGoesOnRefusingDoesNotFillTheLine) {
  RealBench arm;
  arm.line.sent.clear();
  arm.line.refuse_moves = 1'000'000;
  arm.inputs[0] = 0.2;
  arm.run(1.0);
  EXPECT_GT(arm.line.count(command::kSetMove), 5);
  EXPECT_LT(20 * arm.line.count(command::kSetMove), arm.line.count(command::kGetParameter));
  EXPECT_EQ(Ends{arm}.state(), PartState::kMoving) << "it is still to go there";
  arm.inputs[0] = 0.3;  // the newest wins
  arm.line.refuse_moves = 0;
  arm.run(2.0);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, 0.3, 2e-3);
}

TEST(BusGroup, ARefusedStopIsAskedForAgainWhileItMoves) {
  RealBench arm;
  arm.inputs[0] = 1.5;
  arm.run(0.8);
  arm.line.refuse_moves = 2;
  arm.inputs.back() = 0.0;
  arm.run(0.8);
  EXPECT_NEAR(arm.behind.plants[0].joint.velocity, 0.0, 1e-3);
  EXPECT_LT(arm.behind.plants[0].joint.position, 0.6);
}

TEST(BusGroup, NothingMovesAtASpeedThatWasRefused) {
  RealBench arm;
  constexpr std::uint8_t kTargetSpeed = 0x4F;
  arm.inputs[0] = 0.3;
  arm.line.refused = kTargetSpeed;
  arm.run(0.5);
  EXPECT_EQ(arm.line.count(command::kSetMove), 0);
  arm.line.refused = 0;
  arm.run(2.0);
  EXPECT_NEAR(arm.behind.plants[0].joint.position, 0.3, 2e-3);
}

TEST(BusGroup, ARefusedLimitIsAFaultUntilItIsTaken) {
  RealBench arm;
  Ends ends{arm};
  constexpr std::uint8_t kMaxAcc = 0x4A;
  arm.line.refused = kMaxAcc;
  ASSERT_EQ(arm.part->set_parameter("Maximum Acceleration 4", 0.5), std::nullopt);
  arm.run(0.2);
  EXPECT_EQ(ends.state(), PartState::kFault);
  EXPECT_TRUE(ends.module(4) & bit::kCommError);
  EXPECT_FALSE(ends.module(3) & bit::kError);
  const int asked = arm.line.count(command::kSetParameter);
  arm.run(0.5);
  EXPECT_EQ(arm.line.count(command::kSetParameter), asked) << "not for ever";
  arm.line.refused = 0;
  ends.reset();
  arm.run(0.3);
  EXPECT_EQ(ends.state(), PartState::kReady);
  for (const auto& parameter : arm.behind.part->parameters()) {
    if (parameter.name == "Maximum Acceleration 4") {
      EXPECT_NEAR(std::get<double>(parameter.value), 0.5, 1e-6);
    }
  }
}

TEST(BusGroup, SaysWhichModulesItFound) {
  RealBench arm;
  const auto board = arm.part->read_blackboard(0);
  const std::string text(reinterpret_cast<const char*>(board.data()), board.size());
  EXPECT_THAT(
      text, AllOf(HasSubstr("found module 7: firmware 0x4634, serial number 40007\n"), HasSubstr("PRL120")));
}

}  // namespace
}  // namespace visum::test
