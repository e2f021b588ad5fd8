// The client library in front of a real daemon, under each of its clocks.
#include <gmock/gmock.h>

#include <optional>

#include "clients/cpp/visum.h"
#include "protocol/client.h"
#include "tests/clients/daemon_thread.h"

namespace visum {
namespace {

using scene::ClockKind;

class ClientLibrary : public ::testing::Test {
 protected:
  void start(ClockKind clock, double speed = 1.0) { daemon_.emplace(clock, speed); }
  Client connect(const std::string& name) { return Client(daemon_->address(), {.name = name}); }
  protocol::Connection connect_plainly(protocol::Role role) {
    return protocol::Connection("127.0.0.1", daemon_->port(), {1, 1, "other", role, {}});
  }
  std::optional<DaemonThread> daemon_;
};

TEST_F(ClientLibrary, TellsWhatItIsConnectedTo) {
  start(ClockKind::kLockstep);
  Client client = connect("curious");
  EXPECT_EQ(client.server().clock, "lockstep");
  EXPECT_EQ(client.server().tick_ns, 1'000'000);
  EXPECT_EQ(client.server().scene, "amtec_arm");
  EXPECT_TRUE(client.server().simulated);
  EXPECT_THAT(client.part_names(), ::testing::ElementsAre("arm"));
}

TEST_F(ClientLibrary, FindsPortsByGroupNameAndIndex) {
  start(ClockKind::kLockstep);
  Client client = connect("finder");
  const Part arm = client.part("arm");
  EXPECT_EQ(arm.kind(), "amtec_arm");
  const Inputs desired = arm.inputs("Desired Angle");
  ASSERT_EQ(desired.size(), 7u);
  EXPECT_EQ(desired.info(6).name, "Desired Angle 7");
  EXPECT_EQ(desired.info(6).unit, "rad");
  EXPECT_EQ(arm.input("Desired Angle 2").info().index, 1u);
  EXPECT_EQ(arm.input(1).info().name, "Desired Angle 2");
  EXPECT_EQ(arm.output(0).info().name, "Actual Angle 1");
  EXPECT_EQ(arm.outputs("Actual Angle").values().size(), 7u);
  EXPECT_EQ(arm.all_inputs().size(), arm.input_ports().size());
  EXPECT_EQ(arm.all_outputs().size(), arm.output_ports().size());
}

TEST_F(ClientLibrary, BringsTheSampleOfTheTickThatItAdvancedTo) {
  start(ClockKind::kLockstep);
  Client client = connect("stepper");
  Part arm = client.part("arm");
  client.join();
  for (int period = 1; period <= 5; ++period) {
    client.advance_ms(10);
    EXPECT_EQ(client.tick(), 10 * period);
    EXPECT_EQ(client.time_ns(), 10'000'000 * period);
    EXPECT_EQ(arm.sample_tick(), 10 * period);
    arm.read();
    EXPECT_EQ(arm.sample_time_ns(), 10'000'000 * period);
  }
}

// It comes with the advance, from the third period on. What was asked since makes it old.
TEST_F(ClientLibrary, ReadsABlackboardAsItIsNow) {
  start(ClockKind::kLockstep);
  Client client = connect("reader");
  Part arm = client.part("arm");
  arm.acquire();
  client.join();
  const auto period = [&](bool writes) {
    client.advance_ms(1);
    std::vector<double> row{9.0};
    for (const double value : arm.outputs("Actual Angle").values()) row.push_back(value);
    for (const double value : arm.outputs("Actual Finger Position").values()) row.push_back(value);
    if (writes) arm.write_blackboard("Trajectory", std::as_bytes(std::span(row)));
    return arm.read_blackboard("Trajectory").size();
  };
  for (int i = 0; i < 4; ++i) EXPECT_EQ(period(false), 0u);
  EXPECT_EQ(period(true), 80u);
  EXPECT_EQ(period(false), 80u);
  for (int i = 0; i < 4; ++i) {
    client.advance_ms(1);
    EXPECT_THROW(arm.read_blackboard("Trajektory"), Error);
  }
}

TEST_F(ClientLibrary, CountsPeriodsThatAreNoMultipleOfTheTickWithoutDrift) {
  start(ClockKind::kLockstep);
  Client client = connect("odd");
  client.join();
  std::vector<std::int64_t> ticks;
  for (int period = 0; period < 6; ++period) {
    client.advance_ms(2.5);
    ticks.push_back(client.tick());
  }
  EXPECT_THAT(ticks, ::testing::ElementsAre(3, 5, 8, 10, 13, 15));
}

TEST_F(ClientLibrary, MovesTheArmInLockstep) {
  start(ClockKind::kLockstep);
  Client client = connect("mover");
  Part arm = client.part("arm");
  arm.acquire();
  Inputs desired = arm.inputs("Desired Angle");
  const Outputs actual = arm.outputs("Actual Angle");
  client.join();
  const double goal = actual[0] + 0.1;
  desired.set(0, goal);
  arm.write();
  for (int period = 0; period < 200; ++period) client.advance_ms(10);
  EXPECT_NEAR(actual[0], goal, 0.005);
  EXPECT_DOUBLE_EQ(desired[0], goal);
  arm.release();
  EXPECT_FALSE(arm.leased());
}

TEST_F(ClientLibrary, WritesOnlyWhatWasSet) {
  start(ClockKind::kLockstep);
  Client first = connect("first"), second = connect("second");
  first.join();
  {
    Part arm = first.part("arm");
    arm.acquire();
    arm.input("Maximum Speed 3").set(0.25);
    arm.write();
    arm.release();
  }
  // The world has not moved: the second holder's sample cannot show yet what the first one wrote.
  Part arm = second.part("arm");
  arm.acquire();
  arm.input("Maximum Speed 1").set(0.125);
  arm.input("Maximum Speed 5").set(0.5);
  arm.write();
  second.join();
  first.leave();
  second.advance_ticks(1);
  arm.release();
  EXPECT_EQ(arm.input("Maximum Speed 3").value(), 0.25);
  EXPECT_EQ(arm.input("Maximum Speed 1").value(), 0.125);
  EXPECT_EQ(arm.input("Maximum Speed 5").value(), 0.5);
}

TEST_F(ClientLibrary, KeepsWhatWasSetBeforeTheLeaseForTheFirstWrite) {
  start(ClockKind::kLockstep);
  Client client = connect("early");
  Part arm = client.part("arm");
  arm.input("Maximum Speed 1").set(0.125);
  arm.acquire();
  arm.write();
  client.join();
  client.advance_ticks(1);
  arm.release();
  arm.read();
  EXPECT_EQ(arm.input("Maximum Speed 1").value(), 0.125);
}

TEST_F(ClientLibrary, ReleasesTheLeaseWhenThePartGoes) {
  start(ClockKind::kLockstep);
  Client first = connect("first"), second = connect("second");
  first.join();
  {
    Part arm = first.part("arm");
    arm.acquire();
  }
  Part arm = second.part("arm");
  arm.acquire();
  first.advance_ticks(5);
  arm.read();
  EXPECT_EQ(arm.output("Part State").value(), 0.0) << "a release in good order is no fault";
}

TEST_F(ClientLibrary, LeavesThePartInFaultWhenAnExceptionEndsIt) {
  start(ClockKind::kLockstep);
  Client clock = connect("clock");
  clock.join();
  try {
    Client client = connect("careless");
    Part arm = client.part("arm");
    arm.acquire();
    throw std::runtime_error("the controller's own trouble");
  } catch (const std::runtime_error&) {
  }
  Part arm = clock.part("arm");
  for (int tick = 0; tick < 1000 && arm.output("Part State").value() < 2.0; ++tick) clock.advance_ticks(1);
  EXPECT_GE(arm.output("Part State").value(), 2.0);
}

TEST_F(ClientLibrary, RunsUnchangedInRealtimeAndFree) {
  for (const ClockKind clock : {ClockKind::kRealtime, ClockKind::kFree}) {
    start(clock, 10.0);
    Client client = connect("same");
    Part arm = client.part("arm");
    arm.acquire();
    Inputs desired = arm.inputs("Desired Angle");
    const Outputs actual = arm.outputs("Actual Angle");
    client.join();
    const double goal = actual[6] + 0.2;
    std::int64_t last = client.tick();
    for (int period = 0; period < 400 && std::abs(actual[6] - goal) > 0.01; ++period) {
      desired.set(6, goal);
      arm.write();
      client.advance_ms(10);
      EXPECT_GE(client.tick(), last) << "late by less than a period: the next one ends at once";
      last = client.tick();
    }
    EXPECT_NEAR(actual[6], goal, 0.01);
    arm.release();
  }
}

TEST_F(ClientLibrary, KeepsADeadlineAliveByWritingTheSameAgain) {
  start(ClockKind::kLockstep);
  Client client = connect("punctual");
  Part arm = client.part("arm");
  arm.acquire(20'000'000);
  arm.input("Desired Angle 1").set(arm.output("Actual Angle 1").value());
  client.join();
  for (int period = 0; period < 20; ++period) {
    arm.write();
    client.advance_ms(10);
  }
  EXPECT_LT(arm.output("Part State").value(), 2.0);
  EXPECT_NO_THROW(arm.release());
}

TEST_F(ClientLibrary, StartsAnewAfterAReset) {
  start(ClockKind::kLockstep);
  Client client = connect("controller");
  Part arm = client.part("arm");
  arm.acquire();
  client.join();
  const double initial = arm.input("Maximum Speed 1").value();
  arm.input("Maximum Speed 1").set(0.1);
  arm.write();
  client.advance_ticks(10);
  const auto era = client.era();
  connect_plainly(protocol::Role::kAdmin).request(protocol::Reset{});
  client.advance_ticks(10);
  EXPECT_GT(client.era(), era);
  EXPECT_EQ(client.tick(), 10);
  EXPECT_EQ(arm.input("Maximum Speed 1").value(), initial);
}

TEST_F(ClientLibrary, SendsAsOneMessageWhatIsKnownInBetween) {
  start(ClockKind::kLockstep);
  Client client = connect("whole");
  Part arm = client.part("arm");
  arm.acquire();
  Inputs speed = arm.input("Maximum Speed 7"), fingers = arm.inputs("Desired Finger Position");
  client.join();
  speed.set(0.25);
  fingers.set({0.02, 0.02});
  arm.write();
  client.advance_ticks(1);
  speed.set(0.125);
  fingers.set(1, 0.03);
  arm.write();
  EXPECT_THROW(client.advance_ticks(1), Error) << "fingers move together";
  EXPECT_EQ(speed.value(), 0.25) << "all or nothing";
  EXPECT_EQ(fingers[1], 0.02);
  speed.set(0.125);
  arm.input("Maximum Finger Speed 1").set(0.04);
  arm.input("Maximum Finger Speed 2").set(0.04);
  arm.write();
  EXPECT_NO_THROW(client.advance_ticks(1)) << "what was refused is not sent along";
  arm.release();
  arm.read();
  EXPECT_EQ(speed.value(), 0.125);
}

TEST_F(ClientLibrary, KeepsItsOtherLeasesWhenAPartGoesWhoseLeaseWasTaken) {
  start(ClockKind::kLockstep);
  Client client = connect("robbed");
  auto admin = connect_plainly(protocol::Role::kAdmin);
  {
    Part arm = client.part("arm");
    arm.acquire();
    admin.request(protocol::AcquireLease{"arm", 0, true});
  }
  EXPECT_NO_THROW(client.part_names()) << "the connection stands, and with it what else it leases";
  Part arm = client.part("arm");
  admin.request(protocol::ReleaseLease{"arm"});
  arm.acquire();
  admin.request(protocol::AcquireLease{"arm", 0, true});
  EXPECT_THROW(arm.release(), Error);
  EXPECT_FALSE(arm.leased());
}

TEST_F(ClientLibrary, ReadsAndSetsParameters) {
  start(ClockKind::kLockstep);
  Client client = connect("tuner");
  Part arm = client.part("arm");
  const auto list = connect_plainly(protocol::Role::kObserver)
                        .request_as<protocol::ParameterList>(protocol::GetParameters{"arm"});
  ASSERT_FALSE(list.parameters.empty());
  for (const auto& parameter : list.parameters) EXPECT_EQ(arm.parameter(parameter.name), parameter.value);
}

}  // namespace
}  // namespace visum
