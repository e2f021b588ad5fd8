// A mirror in front of two daemons that are reset or go away independently of each other.
#include "server/mirror/mirror.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>

#include "hwparts/servo_group/part_state.h"
#include "tests/gateway/relay.h"
#include "tests/gateway/running_daemon.h"
#include "tests/support/temp_files.h"

namespace visum::mirror {
using namespace visum::gateway;
namespace {

using namespace protocol;
using servo_group::PartState;
using ::testing::HasSubstr;

template <typename Server>
std::string address_of(const Server& server) {
  return "127.0.0.1:" + std::to_string(server.port());
}

PartSample sample_of(Connection& link) {
  return link.request_as<PartSample>(Read{"arm"});
}

// Lets the mirror work until the condition holds.
void work_until(Mirror& mirror, const std::function<bool()>& holds, const char* what) {
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!holds()) {
    ASSERT_LT(std::chrono::steady_clock::now(), patience) << what;
    mirror.pump();
    mirror.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(1));
  }
}

class TwoArms : public ::testing::Test {
 protected:
  TwoArms() {
    for (const auto& port : mirror.description().controller_inputs) inputs.push_back(port.initial);
    admin.request(Resume{});
  }

  void command(const std::string& port, double value) {
    inputs[index_of_input(port)] = value;
    mirror.command(inputs);
  }
  void bump(const std::string& counter) { command(counter, inputs[index_of_input(counter)] + 1.0); }
  std::size_t index_of_input(const std::string& port) const {
    return index_of(mirror.description().controller_inputs, port);
  }
  std::vector<double> with_one_more(const std::string& counter) const {
    auto changed = inputs;
    changed[index_of_input(counter)] += 1.0;
    return changed;
  }

  void expect(const std::function<bool()>& holds, const char* what) { work_until(mirror, holds, what); }
  void expect_state(RunningDaemon& daemon, PartState wanted) {
    expect([&] { return seen(daemon, "Part State") == static_cast<double>(wanted); }, "the state");
  }
  void expect_angle(RunningDaemon& daemon, double angle) {
    expect([&] { return std::abs(seen(daemon, "Actual Angle 1") - angle) < 0.01; }, "the angle");
  }
  void expect_both_there() {
    expect([&] { return mirror.connected(0) && mirror.connected(1); }, "both are there");
  }
  void expect_in_force(const std::string& counter, double count) {
    const auto index = index_of_input(counter);
    for (auto* daemon : {&one.value(), &other.value()})
      expect([&] { return sample(*daemon).controller_inputs[index] == count; }, counter.c_str());
  }

  static PartSample sample(RunningDaemon& daemon) {
    auto look = daemon.connect("look", Role::kObserver);
    return sample_of(look);
  }
  double seen(RunningDaemon& daemon, const std::string& port) const {
    return sample(daemon).sensor_outputs[index_of(mirror.description().sensor_outputs, port)];
  }
  static ParameterValue parameter(RunningDaemon& daemon, const std::string& name) {
    auto link = daemon.connect("look", Role::kObserver);
    for (const auto& known : link.request_as<ParameterList>(GetParameters{"arm"}).parameters)
      if (known.name == name) return known.value;
    ADD_FAILURE() << "no parameter " << name;
    return {};
  }
  void lose(std::size_t arm) {
    (arm == 0 ? one : other).reset();
    expect([&] { return !mirror.connected(arm); }, "it is gone");
  }

  std::optional<RunningDaemon> one{std::in_place, scene::ClockKind::kRealtime};
  std::optional<RunningDaemon> other{std::in_place, scene::ClockKind::kRealtime};
  const std::string address_of_one = address_of(*one), address_of_other = address_of(*other);
  Connection admin = other->connect("admin", Role::kAdmin);
  Mirror mirror{{address_of_one, address_of_other}, "arm", {}};
  std::vector<double> inputs;
};

using MirrorOfWorlds = TwoArms;
using MirrorOfArmsAway = TwoArms;
using MirrorParameters = TwoArms;

TEST_F(MirrorOfWorlds, AWorldThatIsResetCountsAnewAndHaltsAndHomesNobody) {
  bump("Halt");
  expect_in_force("Halt", 1.0);
  bump("Reset");
  expect_in_force("Reset", 1.0);
  admin.request(Reset{});
  command("Desired Angle 1", 0.2);  // perhaps before the mirror has heard of it
  expect([&] { return sample(*other).era == 2; }, "its era");
  mirror.pump();
  command("Desired Angle 1", 0.3);
  expect_angle(*one, 0.3);
  expect_angle(*other, 0.3);
  for (const char* counter : {"Halt", "Reset", "Home"})
    EXPECT_EQ(sample(*other).controller_inputs[index_of_input(counter)], 0.0) << counter;
}

TEST_F(MirrorOfWorlds, AWorldThatIsRestoredGoesOnWithItsOwnCounts) {
  bump("Reset");
  expect_in_force("Reset", 1.0);
  const auto snapshot = admin.request_as<SnapshotTaken>(TakeSnapshot{}).snapshot;
  bump("Halt");
  expect_in_force("Halt", 1.0);
  bump("Reset");
  expect_in_force("Reset", 2.0);
  admin.request(RestoreSnapshot{snapshot});
  expect([&] { return sample(*other).era == 2; }, "its era");
  mirror.pump();
  command("Desired Angle 1", 0.3);
  expect_angle(*other, 0.3);
  EXPECT_EQ(sample(*other).controller_inputs[index_of_input("Halt")], 0.0);
  EXPECT_EQ(sample(*other).controller_inputs[index_of_input("Reset")], 1.0);
  bump("Halt");
  expect_state(*one, PartState::kHalted);
  expect_state(*other, PartState::kHalted);
}

TEST_F(MirrorOfWorlds, AHaltStandsInAWorldThatIsResetUntilTheControllersReset) {
  bump("Halt");
  expect_state(*other, PartState::kHalted);
  admin.request(Reset{});
  expect([&] { return sample(*other).era == 2; }, "its era");
  expect_state(*other, PartState::kHalted);
  bump("Reset");
  expect_state(*one, PartState::kReady);
  expect_state(*other, PartState::kReady);
}

// The controller commands a lower count than the arms have; it is a change all the same.
TEST_F(MirrorOfWorlds, ACountBelowThatOfAnArmIsAChangeThereAsWell) {
  command("Reset", 5.0);
  expect_in_force("Reset", 5.0);
  admin.request(Reset{});
  expect([&] { return sample(*other).era == 2; }, "its era");
  command("Desired Angle 1", 0.05);
  expect_angle(*other, 0.05);
  command("Reset", 1.0);
  expect_in_force("Reset", 1.0);
  bump("Halt");
  expect_state(*one, PartState::kHalted);
  expect_state(*other, PartState::kHalted);
  bump("Reset");
  expect_state(*one, PartState::kReady);
  expect_state(*other, PartState::kReady);
  EXPECT_EQ(mirror.refusals(1), 0u) << mirror.why();
}

TEST_F(MirrorOfWorlds, ACountBeyondWhatAnArmTakesIsAChangeThereAsWell) {
  command("Reset", 5.0);
  expect_in_force("Reset", 5.0);
  const auto snapshot = admin.request_as<SnapshotTaken>(TakeSnapshot{}).snapshot;
  command("Reset", 1.0);
  expect_in_force("Reset", 1.0);
  admin.request(RestoreSnapshot{snapshot});
  command("Desired Angle 1", 0.05);
  expect_angle(*other, 0.05);
  bump("Halt");
  expect_state(*one, PartState::kHalted);  // or its world may take both in one tick
  expect_state(*other, PartState::kHalted);
  command("Reset", mirror.description().controller_inputs[index_of_input("Reset")].maximum);
  expect_state(*one, PartState::kReady);
  expect_state(*other, PartState::kReady);
  EXPECT_EQ(mirror.refusals(1), 0u) << mirror.why();
}

TEST_F(MirrorOfArmsAway, CommandsAreRefusedWhileTheArmsOfALostControllerAreReconnected) {
  EXPECT_EQ(mirror.refuse_now(inputs, with_one_more("Reset")), std::nullopt);
  mirror.controller_lost();
  for (const char* counter : {"Reset", "Home"})
    EXPECT_THAT(mirror.refuse_now(inputs, with_one_more(counter)).value_or(""),
                HasSubstr(address_of_one + " is away"));
  auto elsewhere = inputs;
  elsewhere[index_of_input("Desired Angle 1")] = 0.3;
  EXPECT_NE(mirror.refuse_now(inputs, elsewhere), std::nullopt);
  EXPECT_EQ(mirror.refuse_now(inputs, inputs), std::nullopt) << "nothing new is a sign of life";
  EXPECT_EQ(mirror.refuse_now(inputs, with_one_more("Halt")), std::nullopt);
  expect_both_there();
  EXPECT_EQ(mirror.refuse_now(inputs, with_one_more("Reset")), std::nullopt);
  bump("Reset");
  expect_state(*one, PartState::kReady);
  expect_state(*other, PartState::kReady);
  EXPECT_FALSE(mirror.fault());
}

TEST_F(MirrorOfArmsAway, ACommandThatWasTakenBeforeTheLossWasKnownIsAFaultAndNotDoneLate) {
  mirror.controller_lost();
  bump("Reset");
  EXPECT_TRUE(mirror.fault());
  EXPECT_THAT(mirror.why(), HasSubstr(address_of_one + " was away, and has missed a command"));
  expect_both_there();
  expect_in_force("Halt", 1.0);  // the fault's
  expect_in_force("Reset", 0.0);
  expect_state(*one, PartState::kControllerLost);
  bump("Reset");
  expect_state(*one, PartState::kReady);
  expect_state(*other, PartState::kReady);
  EXPECT_FALSE(mirror.fault());
}

TEST_F(MirrorOfArmsAway, AHaltThatAnArmHasMissedIsGivenWhenItIsBack) {
  mirror.set_parameter("On Controller Lost", std::string("hold"));
  mirror.controller_lost();
  bump("Halt");
  EXPECT_FALSE(mirror.fault());
  expect_both_there();
  expect_state(*one, PartState::kHalted);
  expect_state(*other, PartState::kHalted);
}

TEST_F(MirrorOfArmsAway, WithoutThePrimaryWhatIsDoneOnceIsRefusedUntilTheShadowTakesOver) {
  lose(0);
  EXPECT_THAT(mirror.refuse_now(inputs, with_one_more("Home")).value_or(""),
              HasSubstr(address_of_one + " is away"));
  auto elsewhere = inputs;
  elsewhere[index_of_input("Desired Angle 1")] = 0.3;
  EXPECT_EQ(mirror.refuse_now(inputs, elsewhere), std::nullopt) << "the shadow follows a stream of angles";
  ASSERT_EQ(mirror.switch_to(1, true), std::nullopt);
  EXPECT_EQ(mirror.refuse_now(inputs, with_one_more("Home")), std::nullopt);
  lose(1);
  EXPECT_NE(mirror.refuse_now(inputs, elsewhere), std::nullopt) << "nobody would follow";
}

TEST_F(MirrorParameters, AreOfBothArmsOrOfNone) {
  const std::string name = "Maximum Acceleration 1";
  EXPECT_EQ(mirror.set_parameter(name, 0.5), std::nullopt);
  EXPECT_EQ(parameter(*one, name), ParameterValue(0.5));
  EXPECT_EQ(parameter(*other, name), ParameterValue(0.5));
  lose(1);
  EXPECT_THAT(mirror.set_parameter(name, 0.6).value_or(""), HasSubstr(address_of_other + " is gone"));
  EXPECT_EQ(parameter(*one, name), ParameterValue(0.5));
}

TEST_F(MirrorParameters, AnEmergencyStopReachesTheShadowOfAPrimaryThatIsGone) {
  lose(0);
  EXPECT_THAT(mirror.set_parameter("Emergency Stop", true).value_or(""), HasSubstr(address_of_one));
  EXPECT_EQ(parameter(*other, "Emergency Stop"), ParameterValue(true));
  EXPECT_NE(mirror.set_parameter("Emergency Stop", 1.0), std::nullopt);
}

// A mirror whose primary is behind a relay.
class MirrorOfServers : public ::testing::Test {
 protected:
  void expect(const std::function<bool()>& holds, const char* what) { work_until(mirror, holds, what); }
  // The same arm as a part of another kind, with as many ports but other names.
  std::string scene_of_another_part() {
    const std::string models = VISUM_SOURCE_DIR "/models/";
    std::ifstream file(models + "scenes/amtec_arm.yaml");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto replace = [&text](const std::string& what, const std::string& with) {
      for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
        text.replace(at, what.size(), with);
    };
    replace("../", models);
    replace("kind: amtec_arm", "kind: servo_group");
    return files.write("scene.yaml", text);
  }

  test::TempFiles files;
  RunningDaemon one{scene::ClockKind::kRealtime}, other{scene::ClockKind::kRealtime};
  Relay relay{one.port()};
  Mirror mirror{{address_of(relay), address_of(other)}, "arm", {}};
};

TEST_F(MirrorOfServers, OneThatComesBackWithAnotherPartStaysAway) {
  RunningDaemon stranger(scene_of_another_part(), scene::ClockKind::kRealtime);
  relay.lead_to(stranger.port());
  expect([&] { return !mirror.connected(0); }, "it is gone");
  expect([&] { return relay.ended() > 0 || mirror.connected(0); }, "it is looked at");
  EXPECT_FALSE(mirror.connected(0));
  auto look = stranger.connect("look", Role::kObserver);
  EXPECT_EQ(sample_of(look).controller_inputs.size(), mirror.description().controller_inputs.size());
  relay.lead_to(one.port());
  expect([&] { return mirror.connected(0); }, "it is back");
}

// Neither of them sends samples, so samples do not tell the two apart.
TEST_F(MirrorOfServers, OneThatHangsIsAwayAndOneThatIsPausedIsNot) {
  other.connect("admin", Role::kAdmin).request(Pause{});
  relay.stand_still();
  expect([&] { return !mirror.connected(0); }, "it is gone");
  EXPECT_TRUE(mirror.connected(1));
  const auto& ports = mirror.description().sensor_outputs;
  std::vector<double> outputs(ports.size());
  mirror.read(outputs);
  EXPECT_EQ(outputs[index_of(ports, "Part State")], static_cast<double>(PartState::kFault));
}

}  // namespace
}  // namespace visum::mirror
