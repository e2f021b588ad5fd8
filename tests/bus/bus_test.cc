// Buses of a running daemon, over each kind of link, as clients use them.
#include "server/bus/buses.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "server/gateway/gateway.h"
#include "tests/bus/bus_line.h"
#include "tests/gateway/running_daemon.h"

namespace visum::bus {
using namespace visum::gateway;
namespace {

using powercube::Message;
using powercube::Telegram;
using Kind = Telegram::Kind;

DaemonOptions with(const std::vector<BusAddress>& buses) {
  DaemonOptions options;
  options.buses = buses;
  return options;
}

Telegram ramp(int module, float target) {
  Telegram telegram{Kind::kSet, static_cast<std::uint8_t>(module), {0x0B, 0x04}};
  powercube::put_value(telegram.message, target);
  return telegram;
}

float float_of(const Telegram& answer) {
  return powercube::value_at<float>(answer.message, 2);
}

class EachClock : public testing::TestWithParam<scene::ClockKind> {};

TEST_P(EachClock, IsAnsweredOverAPtyEvenBeforeTimeRuns) {
  LinkFolder folder;
  RunningDaemon daemon(GetParam(), with({{"arm", "pty", folder / "arm.tty", {}}}));
  auto line = BusLine::tty(folder / "arm.tty");
  for (int i = 0; i < 20; ++i) EXPECT_EQ(line.ask(kGetVersion), kVersion);
  EXPECT_EQ(line.ask({Kind::kSet, 1, {0x00}}), (Telegram{Kind::kAnswer, 1, {0x00}}));
}

TEST_P(EachClock, MovesTheArmThatThePortsShow) {
  RunningDaemon daemon(GetParam(), with({{"arm", "tcp", "0", {}}}), 20.0);
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  auto client = daemon.connect("stepper");
  client.request(protocol::Join{});
  line.ask(ramp(1, 0.1f));
  advance(client, 1500);
  EXPECT_NEAR(float_of(line.ask({Kind::kGet, 1, {0x0A, 0x3C}})), 0.1, 1e-3);
  EXPECT_NEAR(sensor(client, "Actual Angle 1"), 0.1, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Bus, EachClock,
                         testing::Values(scene::ClockKind::kRealtime, scene::ClockKind::kLockstep,
                                         scene::ClockKind::kFree),
                         [](const auto& info) { return std::string(scene::name_of(info.param)); });

TEST(Bus, TheFirstFrameStartsTheTime) {
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "tcp", "0", {}}}));
  auto client = daemon.connect("observer", protocol::Role::kObserver);
  const auto tick = [&] { return client.request_as<protocol::ServerStatus>(protocol::Status{}).tick; };
  EXPECT_EQ(tick(), 0);
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  line.ask(kGetVersion);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (tick() == 0 && std::chrono::steady_clock::now() < patience) {
  }
  EXPECT_GT(tick(), 0);
}

TEST(Bus, AnAnswerLeavesInOneWrite) {
  LinkFolder folder;
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "pty", folder / "arm.tty", {}}}));
  auto line = BusLine::tty(folder / "arm.tty");
  for (int i = 0; i < 200; ++i) {
    line.send(Telegram{Kind::kGet, 2, {0x0A, 0x62}});
    const auto bytes = line.read_once();
    ASSERT_FALSE(bytes.empty());
    ASSERT_EQ(bytes.front(), '\x02');
    ASSERT_EQ(bytes.back(), '\x03');
  }
}

TEST(Bus, FramesInOneWriteAndInManyAreTheSame) {
  LinkFolder folder;
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "pty", folder / "arm.tty", {}}}));
  auto line = BusLine::tty(folder / "arm.tty");
  const auto frame = BusLine::serial(kGetVersion);
  std::string many;
  for (int i = 0; i < 20; ++i) many += frame;
  line.send(many);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(line.read_to('\x03'), BusLine::serial(kVersion));
  for (const char byte : frame) line.send(std::string(1, byte));
  EXPECT_EQ(line.read_to('\x03'), BusLine::serial(kVersion));
  line.send("\x03\xff\x02\x02\x10 noise " + frame);
  EXPECT_EQ(line.read_to('\x03'), BusLine::serial(kVersion));
}

TEST(Bus, IsAnsweredWhilePaused) {
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "tcp", "0", {}}}));
  auto admin = daemon.connect("admin", protocol::Role::kAdmin);
  admin.request(protocol::Pause{});
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  EXPECT_EQ(line.ask(kGetVersion), kVersion);
  EXPECT_TRUE(admin.request_as<protocol::ServerStatus>(protocol::Status{}).paused);
}

TEST(Bus, SerialClientsHearOnlyTheirOwnAnswers) {
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "tcp", "0", {}}}));
  const auto name = daemon.buses().at("arm").at(0);
  auto first = BusLine::tcp(name), second = BusLine::tcp(name);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(first.ask(kGetVersion), kVersion);
    EXPECT_EQ(second.ask({Kind::kGet, 4, {0x0A, 0x20}}), (Telegram{Kind::kAnswer, 4, {0x0A, 0x20, 4}}));
  }
}

TEST(Bus, ClientsMayGoInTheMiddleOfAFrame) {
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "tcp", "0", {}}}));
  const auto name = daemon.buses().at("arm").at(0);
  for (int i = 0; i < 100; ++i) {
    auto line = BusLine::tcp(name);
    line.send(BusLine::serial(kGetVersion) + "\x02\x04");
  }
  EXPECT_EQ(BusLine::tcp(name).ask(kGetVersion), kVersion);
}

TEST(Bus, CanClientsHearAnswersAndEachOther) {
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "tcp", "0", {}}, {"arm", "tcp", "0", {}}}));
  auto first = BusLine::tcp(daemon.buses().at("arm").at(0));
  auto second = BusLine::tcp(daemon.buses().at("arm").at(1));  // another link, the same bus
  auto serial = BusLine::tcp(daemon.buses().at("arm").at(1));
  for (auto* line : {&first, &second}) {
    line->send("S6\r");
    EXPECT_EQ(line->read_to('\r'), "\r");
    line->send("O\r");
    EXPECT_EQ(line->read_to('\r'), "\r");
  }
  const Telegram start{Kind::kBroadcast, 0, {0x0F, 0x00}};
  first.send(BusLine::slcan(start));
  EXPECT_EQ(first.read_to('\r'), "z\r");
  EXPECT_EQ(second.read_to('\r'), BusLine::slcan(start));
  first.send(BusLine::slcan(kGetVersion));
  EXPECT_EQ(first.read_to('\r'), "z\r");
  EXPECT_EQ(first.read_to('\r'), BusLine::slcan(kVersion));
  EXPECT_EQ(second.read_to('\r'), BusLine::slcan(kGetVersion));
  EXPECT_EQ(second.read_to('\r'), BusLine::slcan(kVersion));
  EXPECT_EQ(serial.ask({Kind::kGet, 4, {0x0A, 0x20}}).module, 4);  // and no answer to all that came before
}

TEST(Bus, AnSlcanAdapterThatIsClosedCarriesNothing) {
  RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "tcp", "0", {}}}));
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  line.send("V\r");
  EXPECT_EQ(line.read_to('\r'), "V1013\r");
  line.send(BusLine::slcan(kGetVersion));
  EXPECT_EQ(line.read_to('\a'), "\a");
  line.send("O\r");
  EXPECT_EQ(line.read_to('\r'), "\r");
  line.send(BusLine::slcan({Kind::kSet, 1, {0x02}}));
  EXPECT_EQ(line.read_to('\r'), "z\r");
  EXPECT_EQ(line.read_to('\r'), BusLine::slcan({Kind::kAnswer, 1, {0x02}}));
}

// 19 bytes of request and answer at 9600 bit/s: 7 bytes, 7.3 ms, there, and 9 bytes, 9.4 ms, back; 2 ms
// between.
TEST(Bus, ALineThatIsNotIdealTakesItsSimulatedTime) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with({{"arm", "tcp", "0", {9600.0, 2'000'000}}}));
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  auto client = daemon.connect("stepper");
  client.request(protocol::Join{});
  advance(client, 1);
  line.send(kGetVersion);
  int ticks = 0;
  while (line.read_once(0).empty() && ticks < 1000) {
    advance(client, 1);
    ++ticks;
    if (ticks < 10) line.read_once(20);  // an answer that is too early would show here
  }
  EXPECT_GE(ticks, 19);
  EXPECT_LE(ticks, 60);  // the host decides when the request comes
}

// A client that writes at once after a reset is heard in the world as it is then.
TEST(Bus, WhatComesBetweenAResetAndTheNextTickIsNotLost) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, with({{"arm", "tcp", "0", {0.0, 2'000'000}}}));
  auto line = BusLine::tcp(daemon.buses().at("arm").at(0));
  auto client = daemon.connect("stepper", protocol::Role::kAdmin);
  client.request(protocol::Join{});
  advance(client, 5);
  client.request(protocol::Reset{});
  line.send(kGetVersion);
  EXPECT_EQ(line.read_once(100), "") << "lets it come";
  advance(client, 20);
  EXPECT_EQ(line.read_once(1000), BusLine::serial(kVersion));
}

TEST(LineTiming, HasWiresForEachWayOnRs232AndOneBusOnCan) {
  using enum LineTiming::Way;
  using powercube::BusFraming;
  LineTiming serial({9600.0, 0}), can({125'000.0, 0});
  constexpr std::int64_t kMs = 1'000'000;
  const auto request_over = serial.pass(kGetVersion, BusFraming::kSerial, kToModules, 10 * kMs);
  EXPECT_NEAR(static_cast<double>(request_over - 10 * kMs), 7.3e6, 0.1e6);
  const auto answer_over = serial.pass(kVersion, BusFraming::kSerial, kFromModules, 10 * kMs);
  EXPECT_NEAR(static_cast<double>(answer_over - 10 * kMs), 9.4e6, 0.1e6) << "beside the request";
  EXPECT_GT(serial.pass(kGetVersion, BusFraming::kSerial, kToModules, 10 * kMs), request_over + 7 * kMs);
  const auto first = can.pass(kGetVersion, BusFraming::kCan, kToModules, 0);
  EXPECT_GT(can.pass(kVersion, BusFraming::kCan, kFromModules, 0), first);
}

// It never takes longer than its patience, whatever still comes.
TEST(BusThread, SettlesThoughClientsFloodTheBus) {
  using Clock = std::chrono::steady_clock;
  std::vector<BusThread::Wiring> wirings;
  wirings.push_back({open_tcp("0"), 0});
  const auto name = wirings[0].link->name();
  BusThread bus(std::move(wirings), [] {});
  std::string frames;
  for (int i = 0; i < 10'000; ++i) frames += BusLine::serial(kGetVersion);
  std::atomic<int> flooded{0};
  std::atomic<bool> over{false};
  const auto begin = Clock::now();
  const auto flood = [&] {
    auto line = BusLine::tcp(name);
    for (bool first = true; !over && Clock::now() - begin < std::chrono::seconds(15); first = false) {
      line.send(frames);
      if (first) ++flooded;
    }
  };
  std::vector<std::thread> clients;
  for (int i = 0; i < 6; ++i) clients.emplace_back(flood);
  while (flooded < 6) std::this_thread::yield();
  bus.settle({}, std::chrono::milliseconds(200));
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(10));
  over = true;
  for (auto& client : clients) client.join();
}

TEST(Bus, ALinkLeftBehindIsReplacedAndAnythingElseIsNot) {
  LinkFolder folder;
  std::filesystem::create_symlink("/dev/pts/nobody", folder / "stale");
  {
    RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", "pty", folder / "stale", {}}}));
    EXPECT_EQ(BusLine::tty(folder / "stale").ask(kGetVersion), kVersion);
  }
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "stale"));
  std::ofstream(folder / "mine") << "precious";
  for (const char* kind : {"pty", "slcan"}) {
    try {
      RunningDaemon daemon(scene::ClockKind::kRealtime, with({{"arm", kind, folder / "mine", {}}}));
      FAIL() << "replaced a file";
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("mine"), std::string::npos) << error.what();
    }
  }
}

TEST(Bus, APtyTellsWhetherItsClientDiscardsOutput) {
  LinkFolder folder;
  const auto link = open_pty(folder / "arm.tty");
  const auto channel = std::move(link->channels().at(0));
  auto line = BusLine::tty(folder / "arm.tty");
  int telegrams = 0;
  const auto discarded = [&](int queue) {
    ::tcflush(line.fd(), queue);
    pollfd set{channel->fd(), POLLIN, 0};
    EXPECT_EQ(::poll(&set, 1, 10'000), 1);
    EXPECT_TRUE(channel->read([&](const Telegram&, powercube::BusFraming) { ++telegrams; }));
    return channel->client_discarded();
  };
  EXPECT_FALSE(discarded(TCIFLUSH));
  EXPECT_TRUE(discarded(TCOFLUSH));
  EXPECT_FALSE(channel->client_discarded());
  line.send(kGetVersion);
  EXPECT_FALSE(discarded(TCIFLUSH));
  EXPECT_EQ(telegrams, 0);  // what was discarded comes before what was written
}

TEST(Bus, WithoutSocketCanTheKernelIsNamed) {
  const int fd = ::socket(PF_CAN, SOCK_RAW, 1);
  if (fd >= 0) {
    ::close(fd);
    GTEST_SKIP() << "this kernel has AF_CAN";
  }
  try {
    open_socketcan("can0");
    FAIL() << "opened";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("AF_CAN"), std::string::npos) << error.what();
  }
}

TEST(Bus, SocketCanCarriesFramesWhereAnInterfaceIs) {
  const int fd = ::socket(PF_CAN, SOCK_RAW, 1);
  if (fd < 0) GTEST_SKIP() << "no AF_CAN in this kernel";
  ::close(fd);
  const char* interface = std::getenv("VISUM_TEST_CAN");
  if (!interface) GTEST_SKIP() << "VISUM_TEST_CAN names no CAN interface";
  RunningDaemon daemon(scene::ClockKind::kRealtime,
                       with({{"arm", "socketcan", interface, {}}, {"arm", "tcp", "0", {}}}));
  auto other = open_socketcan(interface);
  auto channel = std::move(other->channels().at(0));
  channel->send(kGetVersion);
  pollfd set{channel->fd(), POLLIN, 0};
  ASSERT_EQ(::poll(&set, 1, 10'000), 1);
  Telegram got;
  channel->read([&](const Telegram& telegram, powercube::BusFraming) { got = telegram; });
  EXPECT_EQ(got, kVersion);
}

}  // namespace
}  // namespace visum::bus
