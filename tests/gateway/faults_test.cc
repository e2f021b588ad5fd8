// Faults by protocol, in lockstep: they act from the next tick on, show on the ports, end, and are the same
// in each run.
#include <gtest/gtest.h>

#include <cmath>

#include "hwparts/drive/state_word.h"
#include "hwparts/servo_group/part_state.h"
#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;
namespace bit = drive::state_bit;

class Faults : public ::testing::Test {
 protected:
  Faults() {
    client.request(Join{});
    client.request(AcquireLease{"arm"});
    advance(client, 5);
  }
  void inject(const std::string& kind, std::vector<FaultNumber> numbers = {}, double seconds = 0.0) {
    client.request(InjectFault{"arm", kind, std::move(numbers), std::llround(seconds * 1e9)});
  }
  ErrorCode refused(const std::string& part, const std::string& kind, std::vector<FaultNumber> numbers = {}) {
    return refusal_of([&] { client.request(InjectFault{part, kind, std::move(numbers), 0}); }).code();
  }
  void write(const std::string& port, double value) {
    const auto index = index_of(describe_arm(client).controller_inputs, port);
    client.request(Write{"arm", static_cast<std::uint32_t>(index), {value}});
  }
  double read(const std::string& port) { return sensor(client, port); }
  std::uint32_t word(int joint) {
    return static_cast<std::uint32_t>(read("Module State " + std::to_string(joint)));
  }
  double truth(const std::string& joint) {
    const auto world = client.request_as<WorldDescription>(DescribeWorld{});
    const auto sample = client.request_as<WorldSample>(ReadWorld{});
    for (std::size_t i = 0; i < world.joints.size(); ++i)
      if (world.joints[i].name == joint) return sample.joint_positions.at(i);
    ADD_FAILURE() << "no joint " << joint;
    return 0.0;
  }
  std::size_t active() { return client.request_as<FaultList>(ListFaults{"arm"}).active.size(); }

  RunningDaemon daemon{scene::ClockKind::kLockstep};
  Connection client = daemon.connect("breaker", Role::kAdmin);
};

TEST_F(Faults, AStuckEncoderStandsTripsAndIsListedUntilItIsCleared) {
  const double stood = read("Actual Angle 3");
  inject("encoder_stuck", {{"joint", 3}});
  EXPECT_EQ(active(), 0u) << "it acts from the next tick on";
  write("Desired Angle 3", 0.5);
  advance(client, 1500);
  const auto list = client.request_as<FaultList>(ListFaults{"arm"});
  ASSERT_EQ(list.active.size(), 1u);
  EXPECT_EQ(list.active[0].kind, "encoder_stuck");
  EXPECT_EQ(list.active[0].numbers.at(0).value, 3.0);
  EXPECT_EQ(read("Actual Angle 3"), stood);
  EXPECT_NE(word(3) & bit::kTowError, 0u);
  EXPECT_EQ(word(2) & bit::kError, 0u) << "the others stop without a fault of their own";
  EXPECT_EQ(read("Part State"), static_cast<double>(servo_group::PartState::kFault));
  EXPECT_GT(std::abs(truth("arm/joint_3") - stood), 0.005) << "the joint went, though nobody counted";
  client.request(ClearFault{"arm", "encoder_stuck", 3});
  advance(client, 1);
  EXPECT_EQ(active(), 0u);
  EXPECT_NEAR(read("Actual Angle 3"), truth("arm/joint_3"), 1e-3);
}

TEST_F(Faults, AFaultWithADurationEndsByItself) {
  inject("encoder_offset", {{"joint", 1}, {"offset", 0.01}}, 0.02);
  advance(client, 19);
  EXPECT_EQ(active(), 1u);
  advance(client, 1);
  EXPECT_NEAR(read("Actual Angle 1") - truth("arm/joint_1"), 0.01, 2e-3);
  EXPECT_EQ(active(), 0u) << "none for the tick to come";
}

TEST_F(Faults, AWriteForTheFirstTickAfterASilenceIsHeard) {
  inject("part_silent", {}, 0.02);
  advance(client, 20);
  write("Desired Angle 1", 0.3);
  advance(client, 1);
  EXPECT_EQ(client.request_as<PartSample>(Read{"arm"}).controller_inputs.at(0), 0.3);
}

TEST_F(Faults, EncoderNoiseHasTheDeviationThatWasAskedFor) {
  inject("encoder_noise", {{"joint", 7}, {"deviation", 1e-3}});
  double sum = 0.0, squares = 0.0;
  constexpr int kReadings = 400;
  for (int i = 0; i < kReadings; ++i) {
    advance(client, 1);
    const double off = read("Actual Angle 7") - truth("arm/joint_7");
    sum += off;
    squares += off * off;
  }
  const double mean = sum / kReadings, deviation = std::sqrt(squares / kReadings - mean * mean);
  EXPECT_NEAR(deviation, 1e-3, 1e-4);  // of 400 readings: 3.5 % of it
}

TEST_F(Faults, TorqueBrakeGearAndHeatBreakAtTheDriveThatWasNamed) {
  inject("torque_lost", {{"joint", 2}});
  inject("brake_stuck", {{"joint", 3}});
  inject("gear_slip", {{"joint", 1}, {"effort", 0.5}});
  for (int joint = 1; joint <= 3; ++joint) write("Desired Angle " + std::to_string(joint), 0.5);
  const double second = truth("arm/joint_2"), third = truth("arm/joint_3");
  for (int i = 0; i < 3000 && read("Part State") != static_cast<double>(servo_group::PartState::kFault); ++i)
    advance(client, 1);
  EXPECT_NE((word(2) | word(3)) & bit::kTowError, 0u);
  EXPECT_LT(truth("arm/joint_2"), second + 0.01) << "no torque takes it there";
  EXPECT_NEAR(truth("arm/joint_3"), third, 0.05) << "its brake holds it back: 0.1 rad behind is what trips";
  EXPECT_GT(read("Actual Angle 1") - truth("arm/joint_1"), 0.005) << "the motor went, the joint did not";
  EXPECT_EQ(word(6) & bit::kError, 0u);
  inject("over_temperature", {{"joint", 6}, {"celsius", 400}});
  advance(client, 2);
  EXPECT_NE(word(6) & bit::kFetTemp, 0u);
  EXPECT_EQ(word(7) & bit::kFetTemp, 0u);
}

TEST_F(Faults, ASupplyDipBelowTheMinimumTripsAllDrivesAndEndsWithIt) {
  inject("supply_dip", {{"volts", 10}}, 0.1);
  advance(client, 50);
  for (int joint = 1; joint <= 7; ++joint) EXPECT_NE(word(joint) & bit::kPowVoltErr, 0u) << joint;
  advance(client, 60);
  write("Reset", 1);
  advance(client, 10);
  EXPECT_EQ(word(1) & bit::kError, 0u) << "the supply is back";
}

TEST_F(Faults, TheEmergencyStopBrakesTheArmWhileItIsPressed) {
  inject("emergency_stop");
  advance(client, 300);
  EXPECT_NE(word(1) & bit::kPowVoltErr, 0u);
  EXPECT_NE(word(1) & bit::kBrakeActive, 0u);
  write("Reset", 1);
  advance(client, 10);
  EXPECT_NE(word(1) & bit::kError, 0u) << "still pressed";
  client.request(ClearFault{"arm", "", 0});
  write("Reset", 2);
  advance(client, 10);
  EXPECT_EQ(word(1) & bit::kError, 0u);
}

TEST_F(Faults, ASilentPartShowsNothingNewAndHearsNothing) {
  const double changed = read("Changed"), angle = read("Actual Angle 1");
  write("Desired Angle 1", 0.3);
  advance(client, 1);
  inject("part_silent", {}, 0.5);
  advance(client, 1);
  const double last = read("Changed");
  write("Desired Angle 1", -0.3);
  advance(client, 400);
  EXPECT_GT(last, changed);
  EXPECT_EQ(read("Changed"), last);
  EXPECT_NEAR(read("Actual Angle 1"), angle, 1e-4);
  EXPECT_GT(truth("arm/joint_1"), angle + 0.01) << "its drives do what they were told last";
  advance(client, 110);
  EXPECT_GT(read("Changed"), last + 400);
}

TEST_F(Faults, ADelayedNetworkMakesWritesLateAndReadingsOld) {
  inject("network_delay", {{"ms", 20}});
  advance(client, 40);
  const double changed = read("Changed");
  advance(client, 1);
  EXPECT_EQ(read("Changed"), changed + 1);
  EXPECT_EQ(changed, 45 - 20) << "each tick's reading, 20 ticks old";
  write("Desired Angle 1", 0.3);
  advance(client, 20);
  const auto inputs = [&] { return client.request_as<PartSample>(Read{"arm"}).controller_inputs.at(0); };
  EXPECT_EQ(inputs(), 0.0) << "under way";
  advance(client, 1);
  EXPECT_EQ(inputs(), 0.3);
}

TEST_F(Faults, JitterKeepsTheOrderAndALossyNetworkLosesItsShare) {
  inject("network_delay", {{"ms", 5}, {"jitter_ms", 10}});
  double before = read("Changed");
  for (int i = 0; i < 200; ++i) {
    advance(client, 1);
    const double now = read("Changed");
    ASSERT_GE(now, before);
    before = now;
  }
  client.request(ClearFault{"arm", "network_delay", 0});
  inject("network_loss", {{"share", 0.25}});
  advance(client, 1);
  int lost = 0;
  constexpr int kTicks = 1000;
  for (int i = 0; i < kTicks; ++i) {
    before = read("Changed");
    advance(client, 1);
    lost += read("Changed") == before;
  }
  EXPECT_NEAR(lost, 0.25 * kTicks, 4 * std::sqrt(0.25 * 0.75 * kTicks));
}

TEST_F(Faults, WhatCannotActIsRefusedAndNothingChanges) {
  const auto hash = state_hash(client);
  EXPECT_EQ(refused("arm", "encoder_stuk"), ErrorCode::kUnknownName);
  EXPECT_EQ(refused("leg", "encoder_stuck", {{"joint", 1}}), ErrorCode::kUnknownName);
  EXPECT_EQ(refused("arm", "encoder_stuck", {{"joint", 9}}), ErrorCode::kBadValue) << "it has eight drives";
  EXPECT_EQ(refused("arm", "sensor_off"), ErrorCode::kBadValue) << "an arm is no sensor";
  EXPECT_EQ(refused("arm", "bus_lost"), ErrorCode::kBadValue) << "nobody is on its bus";
  EXPECT_EQ(refused("arm", "gear_slip", {{"joint", 1}, {"effort", 5000}}), ErrorCode::kBadValue)
      << "it breaks long before";
  auto controller = daemon.connect("controller");
  EXPECT_EQ(refusal_of([&] {
              controller.request(InjectFault{"arm", "emergency_stop", {}, 0});
            }).code(),
            ErrorCode::kForbidden);
  EXPECT_EQ(state_hash(client), hash);
}

TEST_F(Faults, SnapshotsHoldThemAndAResetEndsThem) {
  inject("encoder_noise", {{"joint", 2}, {"deviation", 1e-3}});
  inject("network_delay", {{"ms", 3}, {"jitter_ms", 4}});
  write("Desired Angle 2", 0.4);
  advance(client, 20);
  const auto snapshot = client.request_as<SnapshotTaken>(TakeSnapshot{}).snapshot;
  advance(client, 100);
  const auto hash = state_hash(client);
  client.request(ClearFault{"arm", "", 0});
  advance(client, 7);
  client.request(RestoreSnapshot{snapshot});
  EXPECT_EQ(active(), 2u);
  client.request_as<Advanced>(Advance{100});
  EXPECT_EQ(state_hash(client), hash) << "noise, jitter and what is under way go on with the same bits";
  client.request(Reset{});
  EXPECT_EQ(active(), 0u);
}

TEST(SensorFaults, AFrozenSensorRepeatsItsReadingUntilTheFaultEnds) {
  RunningDaemon daemon("sensors.yaml", scene::ClockKind::kLockstep);
  auto client = daemon.connect("breaker", Role::kAdmin);
  client.request(Join{});
  advance(client, 100);
  const auto tracker = [&] { return client.request_as<PartSample>(Read{"tracker"}).sensor_outputs; };
  client.request(InjectFault{"tracker", "sensor_frozen", {}, 100'000'000});
  advance(client, 30);
  const auto frozen = tracker();
  advance(client, 60);
  auto now = tracker();
  EXPECT_GT(now.back(), frozen.back()) << "`Changed` counts";
  now.back() = frozen.back();
  EXPECT_EQ(now, frozen);
  advance(client, 60);
  EXPECT_NE(tracker().front(), frozen.front());
  EXPECT_EQ(refusal_of([&] {
              client.request(InjectFault{"camera", "sensor_garbage", {}, 0});
            }).code(),
            ErrorCode::kBadValue);
}

TEST(SensorFaults, ABlackboardComesInTimeAndWhole) {
  RunningDaemon daemon("sensors.yaml", scene::ClockKind::kLockstep);
  auto client = daemon.connect("breaker", Role::kAdmin);
  const std::vector<protocol::FaultNumber> delay{{"ms", 20}}, loss{{"share", 0.5}};
  for (const char* part : {"camera", "scan"}) {
    for (const auto& fault :
         {InjectFault{part, "network_delay", delay, 0}, InjectFault{part, "network_loss", loss, 0}}) {
      const auto refusal = refusal_of([&] { client.request(fault); });
      EXPECT_EQ(refusal.code(), ErrorCode::kBadValue);
      EXPECT_NE(std::string(refusal.what()).find("on a blackboard"), std::string::npos) << refusal.what();
    }
  }
  client.request(InjectFault{"tracker", "network_delay", delay, 0});
}

}  // namespace
}  // namespace visum::gateway
