// Faults of a bus, in lockstep, as a client on its line sees them.
#include <gtest/gtest.h>

#include <cmath>

#include "hwparts/drive/state_word.h"
#include "server/bus/bus_thread.h"
#include "tests/bus/bus_line.h"
#include "tests/gateway/running_daemon.h"

namespace visum::bus {
using namespace visum::gateway;
namespace {

using powercube::Telegram;
using Kind = Telegram::Kind;

const Telegram kGetAddress{Kind::kGet, 4, {0x0A, 0x20}};
const Telegram kAddress{Kind::kAnswer, 4, {0x0A, 0x20, 4}};

DaemonOptions on_a_bus() {
  DaemonOptions options;
  options.buses = {{"arm", "tcp", "0", {}}};
  return options;
}

class BusFaults : public testing::Test {
 protected:
  BusFaults() { client.request(protocol::Join{}); }
  void inject(const std::string& kind, const std::string& number, double value) {
    client.request(protocol::InjectFault{"arm", kind, {{number, value}}, 0});
    advance(client, 1);
  }
  void clear() {
    client.request(protocol::ClearFault{"arm", "", 0});
    advance(client, 1);
  }

  RunningDaemon daemon{scene::ClockKind::kLockstep, on_a_bus()};
  BusLine line = BusLine::tcp(daemon.buses().at("arm").at(0));
  protocol::Connection client = daemon.connect("breaker", protocol::Role::kAdmin);
};

TEST_F(BusFaults, ALostFrameIsSilence) {
  EXPECT_EQ(line.ask(kGetVersion), kVersion);
  inject("bus_lost", "share", 1.0);
  line.send(kGetVersion);
  EXPECT_EQ(line.read_once(50), "");
  clear();
  EXPECT_EQ(line.ask(kGetAddress), kAddress);
}

TEST_F(BusFaults, ACorruptedFrameHasAWrongCheckSum) {
  inject("bus_corrupted", "share", 1.0);
  line.send(kGetVersion);
  const auto bytes = line.read_to('\x03');
  const auto decoded =
      powercube::decode_serial({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  EXPECT_EQ(decoded.telegram, kVersion);
  EXPECT_FALSE(decoded.checksum_ok);
  clear();
  EXPECT_EQ(line.ask(kGetAddress), kAddress);
}

TEST_F(BusFaults, FramesComeTwiceAsOftenAsTheirShare) {
  constexpr int kFrames = 400;
  inject("bus_doubled", "share", 0.25);
  std::string all;
  for (int i = 0; i < kFrames; ++i) all += BusLine::serial(kGetVersion);
  line.send(all + BusLine::serial(kGetAddress));
  int heard = 0;
  while (line.read_to('\x03') == BusLine::serial(kVersion)) ++heard;
  EXPECT_NEAR(heard - kFrames, 0.25 * kFrames, 4 * std::sqrt(0.25 * 0.75 * kFrames));
}

TEST_F(BusFaults, ALateAnswerTakesItsSimulatedTime) {
  inject("bus_late", "ms", 15.0);
  line.send(kGetVersion);
  int ticks = 0;
  while (line.read_once(0).empty() && ticks < 1000) {
    advance(client, 1);
    ++ticks;
    if (ticks < 10) line.read_once(20);  // an answer that is too early would show here
  }
  EXPECT_GE(ticks, 15);
  EXPECT_LE(ticks, 60);  // the host decides when the request comes
}

TEST_F(BusFaults, LateAnswersThatWaitHaveAMaximum) {
  constexpr int kChunks = 5, kFrames = 300;
  inject("bus_late", "ms", 1000.0);
  std::string frames;
  for (int i = 0; i < kFrames; ++i) frames += BusLine::serial(kGetVersion);
  for (int i = 0; i < kChunks; ++i) {
    line.send(frames);
    EXPECT_EQ(line.read_once(50), "") << "lets them come";
    advance(client, 1);
  }
  advance(client, 1100);
  std::string heard;
  for (std::string more; !(more = line.read_once(300)).empty();) heard += more;
  EXPECT_LE(heard.size() / BusLine::serial(kVersion).size(), BusThread::kQueue);
  EXPECT_GT(heard.size(), 0u);
}

// The line's wires are free while an answer is not ready.
TEST(BusFaultsOnASlowLine, ALateAnswerDoesNotHoldUpAHalt) {
  DaemonOptions options;
  options.buses = {{"arm", "tcp", "0", {115200.0, 0}}};
  RunningDaemon daemon(scene::ClockKind::kLockstep, options);
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  auto client = daemon.connect("breaker", protocol::Role::kAdmin);
  client.request(protocol::Join{});
  client.request(protocol::InjectFault{"arm", "bus_late", {{"ms", 500.0}}, 0});
  const auto let_it_come = [&](int ticks) {
    line.read_once(50);
    advance(client, ticks);
  };
  let_it_come(1);
  line.send(kGetVersion);
  let_it_come(10);
  line.send(Telegram{Kind::kSet, 1, {0x02}});
  int ticks = 0;
  const auto halted = [&] {
    return (static_cast<std::uint32_t>(sensor(client, "Module State 1")) & drive::state_bit::kHalted) != 0;
  };
  for (; ticks < 400 && !halted(); ++ticks) let_it_come(ticks < 10 ? 1 : 10);
  EXPECT_LT(ticks, 30);
}

}  // namespace
}  // namespace visum::bus
