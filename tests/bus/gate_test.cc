// Grade L1: only a program's requests over a bus let the world run.
#include <optional>
#include <thread>

#include "server/bus/cycle_gate.h"
#include "tests/bus/bus_line.h"
#include "tests/gateway/running_daemon.h"

namespace visum::bus {
using namespace visum::gateway;
namespace {

using powercube::Telegram;
using protocol::Advanced;
using protocol::Gate;
using protocol::Join;
using protocol::OnTimeout;
using protocol::ServerStatus;
using protocol::Status;

Telegram get(std::uint8_t module, std::uint8_t parameter) {
  return {Telegram::Kind::kGet, module, {0x0A, parameter}};
}
constexpr std::uint8_t kStateId = 0x27, kVersionId = 0x1D;

BusItem item(const Telegram& telegram) {
  BusItem item;
  item.telegram = telegram;
  return item;
}

TEST(CycleGate, AskingTheSameAgainEndsACycle) {
  CycleGate gate({10, 0, {}}, 0);
  for (std::uint8_t module = 1; module <= 3; ++module) gate.ask(item(get(module, kStateId)));
  gate.ask(item(get(1, kVersionId)));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(gate.next(0)) << i;
  for (int cycle = 0; cycle < 3; ++cycle) {
    for (std::uint8_t module = 1; module <= 3; ++module) gate.ask(item(get(module, kStateId)));
    EXPECT_FALSE(gate.next(10 * cycle)) << "the period comes first";
    EXPECT_EQ(gate.granted_tick(), 10 * (cycle + 1));
    EXPECT_FALSE(gate.next(10 * cycle + 9));
    for (int module = 1; module <= 3; ++module)
      EXPECT_EQ(gate.next(10 * (cycle + 1)).value().telegram.module, module) << "all of them in one cycle";
    EXPECT_FALSE(gate.next(10 * (cycle + 1)));
  }
}

TEST(CycleGate, ANamedFrameIsObeyedAndItsAnswerWaits) {
  CycleGate gate({20, 2, {0x0A, kStateId}}, 100);
  gate.ask(item(get(1, kStateId)));
  gate.ask(item(get(1, kStateId)));
  gate.ask(item(get(2, kStateId)));
  gate.ask(item(get(1, kStateId)));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(gate.next(100)) << i;
  EXPECT_EQ(gate.granted_tick(), 120);
  gate.hold({item(get(2, kStateId)), 0});
  EXPECT_FALSE(gate.next(119)) << "what comes meanwhile waits";
  EXPECT_TRUE(gate.released(119).empty());
  EXPECT_EQ(gate.released(120).size(), 1u);
  EXPECT_TRUE(gate.released(120).empty()) << "once";
  EXPECT_TRUE(gate.next(120));
}

TEST(CycleGate, AnEraBeginsWithACycle) {
  CycleGate gate({10, 0, {}}, 0);
  gate.ask(item(get(1, kStateId)));
  EXPECT_TRUE(gate.next(0));
  gate.begin_era(0);
  gate.ask(item(get(1, kStateId)));
  EXPECT_TRUE(gate.next(0)) << "nothing was asked in this world";
  gate.ask(item(get(1, kStateId)));
  EXPECT_FALSE(gate.next(0));
  gate.begin_era(0);
  EXPECT_TRUE(gate.next(0)) << "what waits is the first";
  gate.ask(item(get(1, kStateId)));
  EXPECT_FALSE(gate.next(0)) << "and is asked again";
  EXPECT_EQ(gate.granted_tick(), 10);
}

class Gates : public testing::Test {
 protected:
  DaemonOptions with_bus(BusTiming timing = {}) const {
    DaemonOptions options;
    options.buses = {{"arm", "pty", folder_ / "arm.tty", timing}};
    return options;
  }
  static protocol::Connection keeper(RunningDaemon& daemon, const Join& join) {
    auto keeper = daemon.connect("poller");
    keeper.request(join);
    return keeper;
  }
  static std::int64_t tick_of(protocol::Connection& client) {
    return client.request_as<ServerStatus>(Status{}).tick;
  }
  BusLine line() const { return BusLine::tty(folder_ / "arm.tty"); }
  LinkFolder folder_;
};

TEST_F(Gates, LetTheWorldRunByAPeriodForEachCycle) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with_bus());
  auto client = keeper(daemon, {0, 1, OnTimeout::kHold, Gate{"arm", "", 20'000'000}});
  auto line = this->line();
  for (int cycle = 0; cycle < 20; ++cycle)
    for (std::uint8_t module = 1; module <= 8; ++module) {
      EXPECT_EQ(line.ask(get(module, kStateId)).module, module);
      EXPECT_EQ(tick_of(client), 20 * cycle) << "the answer is there when its step is done";
    }
  const auto status = client.request_as<ServerStatus>(Status{});
  ASSERT_EQ(status.lockstep.size(), 1u);
  EXPECT_EQ(status.lockstep[0].grade, 1u);
}

TEST_F(Gates, OfANamedFrameHoldItsAnswer) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with_bus());
  auto client = keeper(daemon, {0, 1, OnTimeout::kHold,
                                Gate{"arm", "", 5'000'000, 3, {std::byte{0x0A}, std::byte{kStateId}}}});
  auto line = this->line();
  for (int cycle = 0; cycle < 20; ++cycle) {
    line.ask(get(1, kStateId));
    line.ask(get(1, kStateId));
    EXPECT_EQ(tick_of(client), 5 * cycle);
    line.ask(get(3, kStateId));
    EXPECT_EQ(tick_of(client), 5 * (cycle + 1));
  }
}

TEST_F(Gates, GiveALineItsTime) {
  BusTiming slow;
  slow.delay_ns = 3'000'000;
  RunningDaemon daemon(scene::ClockKind::kLockstep, with_bus(slow));
  auto client = keeper(daemon, {0, 1, OnTimeout::kHold, Gate{"arm", "", 10'000'000}});
  auto line = this->line();
  line.ask(get(1, kStateId));
  const auto first = tick_of(client);
  EXPECT_GE(first, 3);
  line.ask(get(1, kStateId));
  EXPECT_EQ(tick_of(client), 2 * first + 10);
}

TEST_F(Gates, ThatCloseServeWhatWaits) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with_bus());
  auto other = daemon.connect("other");
  other.request(Join{});  // holds the world
  std::optional<protocol::Connection> client =
      keeper(daemon, {0, 1, OnTimeout::kHold, Gate{"arm", "", 20'000'000}});
  auto line = this->line();
  line.ask(get(1, kStateId));
  line.send(get(1, kStateId));
  EXPECT_EQ(line.read_once(50), "") << "its period is not over";
  client.reset();
  EXPECT_NE(line.read_to('\x03'), "");
  EXPECT_EQ(tick_of(other), 0);
}

TEST_F(Gates, AResetHoldsNobody) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with_bus());
  auto admin = daemon.connect("admin", protocol::Role::kAdmin);
  auto client = keeper(daemon, {0, 1, OnTimeout::kHold, Gate{"arm", "", 20'000'000}});
  auto line = this->line();
  for (int i = 0; i < 5; ++i) line.ask(get(1, kStateId));
  for (const std::uint8_t module : {2, 1}) {
    admin.request(protocol::Reset{});
    EXPECT_EQ(tick_of(admin), 0);
    line.ask(get(module, kStateId));
    EXPECT_EQ(tick_of(admin), 0) << "as in a fresh world";
    line.ask(get(module, kStateId));
    EXPECT_EQ(tick_of(admin), 20);
  }
}

TEST_F(Gates, APausedWorldHoldsTheAnswer) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with_bus());
  auto admin = daemon.connect("admin", protocol::Role::kAdmin);
  auto client = keeper(daemon, {0, 1, OnTimeout::kHold, Gate{"arm", "", 20'000'000}});
  auto line = this->line();
  line.ask(get(1, kStateId));
  admin.request(protocol::Pause{});
  line.send(get(1, kStateId));
  EXPECT_EQ(line.read_once(50), "");
  EXPECT_EQ(tick_of(admin), 0);
  admin.request(protocol::Resume{});
  EXPECT_NE(line.read_to('\x03'), "");
  EXPECT_EQ(tick_of(admin), 20);
}

TEST_F(Gates, OfSessionsHoldWhatIsAskedAgain) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto keeper = daemon.connect("visum exec");
  keeper.request(Join{0, 1, OnTimeout::kHold, Gate{"", "poller", 10'000'000}});
  auto poller = daemon.connect("poller");
  poller.request(protocol::AcquireLease{"arm"});
  for (int cycle = 0; cycle < 20; ++cycle) {
    EXPECT_EQ(poller.request_as<protocol::PartSample>(protocol::Read{"arm"}).tick, 10 * cycle);
    poller.request(protocol::Write{"arm", 0, {0.01 * cycle}});
    EXPECT_EQ(tick_of(poller), 10 * cycle) << "what is no part of a cycle costs no time";
  }
  const auto status = keeper.request_as<ServerStatus>(Status{});
  EXPECT_TRUE(status.free_running.empty()) << "it keeps in step";
}

TEST_F(Gates, OfSessionsBeginACycleWithAnEra) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto admin = daemon.connect("admin", protocol::Role::kAdmin);
  auto keeper = daemon.connect("visum exec");
  keeper.request(Join{0, 1, OnTimeout::kHold, Gate{"", "poller", 10'000'000}});
  auto poller = daemon.connect("poller");
  const auto read = [&poller] { return poller.request_as<protocol::PartSample>(protocol::Read{"arm"}).tick; };
  read();
  read();
  admin.request(protocol::Reset{});
  EXPECT_EQ(read(), 0);
  EXPECT_EQ(read(), 10);
}

TEST_F(Gates, OfSessionsThatHoldARequestAskItAnewInAnotherEra) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto admin = daemon.connect("admin", protocol::Role::kAdmin);
  auto other = daemon.connect("other");
  other.request(Join{});  // holds the world
  auto keeper = daemon.connect("visum exec");
  keeper.request(Join{0, 1, OnTimeout::kHold, Gate{"", "poller", 10'000'000}});
  auto poller = daemon.connect("poller");
  poller.request(protocol::Read{"arm"});
  const auto held = poller.send(protocol::Read{"arm"});
  EXPECT_FALSE(poller.wait_for(held, std::chrono::milliseconds(50)));
  admin.request(protocol::Reset{});
  EXPECT_EQ(std::get<protocol::PartSample>(poller.wait(held)).tick, 0);
  const auto again = poller.send(protocol::Read{"arm"});
  EXPECT_FALSE(poller.wait_for(again, std::chrono::milliseconds(50))) << "its period is not over";
}

TEST_F(Gates, OfSessionsThatCloseServeWhatWaits) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto other = daemon.connect("other");
  other.request(Join{});
  std::optional<protocol::Connection> keeper = daemon.connect("visum exec");
  keeper->request(Join{0, 1, OnTimeout::kHold, Gate{"", "poller", 10'000'000}});
  auto poller = daemon.connect("poller");
  poller.request(protocol::Read{"arm"});
  const auto held = poller.send(protocol::Read{"arm"});
  EXPECT_FALSE(poller.wait_for(held, std::chrono::milliseconds(50)));
  keeper.reset();
  EXPECT_EQ(std::get<protocol::PartSample>(poller.wait(held)).tick, 0);
}

TEST_F(Gates, ThatCannotBeAreRefused) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with_bus());
  auto client = daemon.connect("confused");
  const std::vector<std::byte> frame{std::byte{0x0B}};
  const Gate wrong[] = {{"", ""},
                        {"arm", "client"},
                        {"leg", ""},
                        {"arm", "", -1},
                        {"arm", "", 1'500'000},
                        {"arm", "", std::numeric_limits<std::int64_t>::max()},
                        {"arm", "", 0, 32, frame},
                        {"arm", "", 0, 0, frame},
                        {"arm", "", 0, 3},
                        {"arm", "", 0, 3, std::vector<std::byte>(9)},
                        {"", "client", 0, 3, frame}};
  for (const auto& gate : wrong)
    EXPECT_EQ(refusal_of([&] {
                client.request(Join{0, 1, OnTimeout::kEnd, gate});
              }).code(),
              protocol::ErrorCode::kBadValue)
        << gate.part << gate.client << gate.period_ns;
  EXPECT_EQ(refusal_of([&] { client.request(Join{0, 1}); }).code(), protocol::ErrorCode::kBadValue);
  EXPECT_EQ(refusal_of([&] {
              client.request(Join{0, 2, OnTimeout::kEnd, Gate{"arm"}});
            }).code(),
            protocol::ErrorCode::kBadValue);
  client.request(Join{0, 1, OnTimeout::kEnd, Gate{"arm"}});
  auto second = daemon.connect("second");
  EXPECT_EQ(refusal_of([&] {
              second.request(Join{0, 1, OnTimeout::kEnd, Gate{"arm"}});
            }).code(),
            protocol::ErrorCode::kBadValue);
}

TEST_F(Gates, BelongToLockstep) {
  RunningDaemon daemon(scene::ClockKind::kFree, with_bus());
  auto client = daemon.connect("poller");
  EXPECT_EQ(refusal_of([&] {
              client.request(Join{0, 1, OnTimeout::kEnd, Gate{"arm"}});
            }).code(),
            protocol::ErrorCode::kBadValue);
}

}  // namespace
}  // namespace visum::bus
