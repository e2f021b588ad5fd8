// Advance with follow_buses: when a program's telegrams are handled and answered, in the world's time.
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/bus/bus_thread.h"
#include "tests/bus/bus_line.h"
#include "tests/gateway/running_daemon.h"

namespace visum::bus {
using namespace visum::gateway;
namespace {

using powercube::Telegram;
using protocol::Advance;
using protocol::Advanced;
using protocol::Join;

DaemonOptions with(const BusAddress& bus) {
  DaemonOptions options;
  options.buses = {bus};
  return options;
}

class FollowBuses : public testing::Test {
 protected:
  static protocol::Connection member(RunningDaemon& daemon) {
    auto client = daemon.connect("keeper");
    client.request(Join{0, 2, protocol::OnTimeout::kHold});
    return client;
  }
  LinkFolder folder_;
};

TEST_F(FollowBuses, WhatWasSaidIsAnsweredBeforeTheFirstTick) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with({"arm", "pty", folder_ / "arm.tty", {}}));
  auto client = member(daemon);
  auto line = BusLine::tty(folder_ / "arm.tty");
  std::uint64_t said = 0;
  for (int i = 0; i < 200; ++i) {
    line.send(kGetVersion);
    const auto reply = client.request_as<Advanced>(Advance{1000, true, said, {}});
    EXPECT_EQ(reply.tick, 0);
    EXPECT_EQ(reply.bus_said, said + BusLine::serial(kVersion).size());
    said = reply.bus_said;
    EXPECT_EQ(line.read_once(0), BusLine::serial(kVersion)) << i;
  }
  EXPECT_EQ((client.request_as<Advanced>(Advance{7, true, said, {}})).tick, 7) << "nobody says anything";
}

TEST_F(FollowBuses, TheWorldStopsWhereAnAnswerCameLater) {
  BusTiming slow;
  slow.delay_ns = 5'000'000;
  RunningDaemon daemon(scene::ClockKind::kLockstep, with({"arm", "pty", folder_ / "arm.tty", slow}));
  auto client = member(daemon);
  auto line = BusLine::tty(folder_ / "arm.tty");
  line.send(kGetVersion);
  const auto reply = client.request_as<Advanced>(Advance{1000, true, 0, {}});
  EXPECT_GE(reply.tick, 5);
  EXPECT_LE(reply.tick, 6);
  EXPECT_EQ(line.read_once(0), BusLine::serial(kVersion));
}

TEST_F(FollowBuses, OverTcpAsManyBytesAreWaitedForAsWereWritten) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with({"arm", "tcp", "0", {}}));
  auto client = member(daemon);
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  protocol::Stream stream{line.port(), 0, 0};
  for (int i = 0; i < 200; ++i) {
    line.send(kGetVersion);
    stream.written += BusLine::serial(kGetVersion).size();
    const auto reply = client.request_as<Advanced>(Advance{1000, true, 0, {stream}});
    ASSERT_EQ(reply.tick, 0);
    ASSERT_EQ(reply.streams.size(), 1u);
    EXPECT_EQ(reply.streams[0].heard, stream.written);
    stream.heard = reply.streams[0].written;
    EXPECT_EQ(line.read_to('\x03'), BusLine::serial(kVersion));
  }
  EXPECT_EQ((client.request_as<Advanced>(Advance{7, true, 0, {stream}})).tick, 7);
}

TEST_F(FollowBuses, AConnectionThatIsGoneHoldsNobody) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with({"arm", "tcp", "0", {}}));
  auto client = member(daemon);
  std::optional<BusLine> line = BusLine::tcp(daemon.buses().at("arm").at(0));
  const protocol::Stream stream{line->port(), BusLine::serial(kGetVersion).size(), 0};
  line->send(kGetVersion);
  line.reset();
  const auto reply = client.request_as<Advanced>(Advance{0, true, 0, {stream}});
  const protocol::Stream told{stream.port, stream.written, reply.streams.at(0).written};
  EXPECT_EQ((client.request_as<Advanced>(Advance{7, true, 0, {told}})).tick, 7);
}

TEST_F(FollowBuses, AStreamHasAPort) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with({"arm", "tcp", "0", {}}));
  auto client = member(daemon);
  for (const std::uint32_t port : {0u, 65536u})
    EXPECT_EQ(refusal_of([&] {
                client.request(Advance{1, true, 0, {{port, 1, 0}}});
              }).code(),
              protocol::ErrorCode::kBadValue)
        << port;
}

TEST_F(FollowBuses, BelongsToLockstep) {
  RunningDaemon daemon(scene::ClockKind::kFree);
  auto client = member(daemon);
  EXPECT_EQ(refusal_of([&] {
              client.request(Advance{1, true, 0, {}});
            }).code(),
            protocol::ErrorCode::kBadValue);
}

TEST_F(FollowBuses, StatusTellsGradeAndNote) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = member(daemon);
  client.request(protocol::Note{"waits for thread 7"});
  const auto status = client.request_as<protocol::ServerStatus>(protocol::Status{});
  ASSERT_EQ(status.lockstep.size(), 1u);
  EXPECT_EQ(status.lockstep[0].grade, 2u);
  EXPECT_EQ(status.lockstep[0].note, "waits for thread 7");
  EXPECT_EQ(refusal_of([&] { client.request(protocol::Note{std::string(201, 'x')}); }).code(),
            protocol::ErrorCode::kBadValue);
}

// Only a bus over TCP.
class SettleOverTcp : public testing::Test {
 protected:
  SettleOverTcp() {
    std::vector<BusThread::Wiring> wirings;
    wirings.push_back({open_tcp("0"), 0});
    name_ = wirings[0].link->name();
    bus_ = std::make_unique<BusThread>(std::move(wirings), [this] { ++wake_ups_; });
  }
  std::uint64_t heard_from(const BusLine& line) {
    std::vector<protocol::Stream> streams{{line.port(), 0, 0}};
    bus_->fill_in(streams);
    return streams[0].heard;
  }
  const std::uint64_t frame_ = BusLine::serial(kGetVersion).size();
  std::string name_;
  std::atomic<int> wake_ups_{0};  // for requests
  std::unique_ptr<BusThread> bus_;
};

TEST_F(SettleOverTcp, WhoIsTurnedAwayHoldsNobody) {
  std::vector<BusLine> lines;
  for (std::size_t i = 0; i < BusThread::kMaxChannels; ++i) lines.push_back(BusLine::tcp(name_));
  auto one_more = BusLine::tcp(name_);
  EXPECT_EQ(one_more.read_once(), "") << "the end of the connection";
  lines[0].send(kGetVersion);
  EXPECT_TRUE(bus_->settle({{one_more.port(), frame_, 0}, {lines[0].port(), frame_, 0}}));
  EXPECT_EQ(heard_from(lines[0]), frame_);
}

TEST_F(SettleOverTcp, AConnectionThatDoesNotComeIsWaitedForOnce) {
  auto line = BusLine::unconnected();
  EXPECT_FALSE(bus_->settle({{line.port(), frame_, 0}}));
  EXPECT_TRUE(bus_->settle({{line.port(), frame_, 0}}));
}

TEST_F(SettleOverTcp, AConnectionThatComesAfterAllIsFollowed) {
  auto line = BusLine::unconnected();
  bus_->settle({{line.port(), frame_, 0}});
  line.connect(name_);
  line.send(kGetVersion);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (heard_from(line) < frame_ && std::chrono::steady_clock::now() < patience) {
  }
  line.send(kGetVersion);
  EXPECT_TRUE(bus_->settle({{line.port(), 2 * frame_, 0}}));
  EXPECT_EQ(heard_from(line), 2 * frame_);
  EXPECT_FALSE(bus_->settle({{line.port(), 3 * frame_, 0}}, std::chrono::milliseconds(20)));
}

TEST_F(SettleOverTcp, TheThreadIsNotWokenForWhatIsSettled) {
  constexpr int kRounds = 200;
  auto line = BusLine::tcp(name_);
  BusItem item;
  for (std::uint64_t round = 1; round <= kRounds; ++round) {
    line.send(kGetVersion);
    ASSERT_TRUE(bus_->settle({{line.port(), round * frame_, 0}}));
    EXPECT_TRUE(bus_->next_request(item));
  }
  EXPECT_LT(wake_ups_, kRounds / 4) << "only where a round took longer than the thread rests";
}

TEST_F(SettleOverTcp, AClientThatIsNotFollowedIsHeardAllTheSame) {
  auto followed = BusLine::tcp(name_), other = BusLine::tcp(name_);
  for (std::uint64_t round = 1; round <= 3; ++round) {
    followed.send(kGetVersion);
    ASSERT_TRUE(bus_->settle({{followed.port(), round * frame_, 0}}));
    other.send(kGetVersion);
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (heard_from(other) < round * frame_ && std::chrono::steady_clock::now() < patience)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(heard_from(other), round * frame_) << "without another settle()";
  }
}

}  // namespace
}  // namespace visum::bus
