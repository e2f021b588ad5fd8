// Emergency stops past the sessions: each clock, each way, and whatever the sessions are busy with.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "protocol/stop_call.h"
#include "tests/gateway/gateway_rig.h"
#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using namespace std::chrono_literals;

constexpr auto kBound = 30s;  // a guard against hanging for ever, not a measure

StopNews stop(const RunningDaemon& daemon, const std::string& part = "arm") {
  return call_stop("127.0.0.1", daemon.port(), part, "", kBound, [](const StopNews&) {});
}

bool is_stopped(Connection& client) {
  for (const auto& parameter : client.request_as<ParameterList>(GetParameters{"arm"}).parameters)
    if (parameter.name == kEmergencyStop) return std::get<bool>(parameter.value);
  return false;
}

TEST(EmergencyStop, ActsWithEveryClock) {
  for (const auto clock :
       {scene::ClockKind::kRealtime, scene::ClockKind::kLockstep, scene::ClockKind::kFree}) {
    RunningDaemon daemon(clock);
    auto client = daemon.connect("admin", Role::kAdmin);
    ASSERT_FALSE(is_stopped(client));
    EXPECT_EQ(stop(daemon).state, StopNews::State::kActed) << static_cast<int>(clock);
    EXPECT_TRUE(is_stopped(client));
    client.request(SetParameter{"arm", kEmergencyStop, false});
    EXPECT_FALSE(is_stopped(client));
    EXPECT_EQ(stop(daemon, "").state, StopNews::State::kActed);
    EXPECT_TRUE(is_stopped(client));
  }
}

TEST(EmergencyStop, AnUnknownPartIsRefused) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  const auto news = stop(daemon, "amr");
  EXPECT_EQ(news.state, StopNews::State::kRefused);
  EXPECT_EQ(news.refusal, StopRefusal::kPart);
}

// A Status that takes as long as the test wants keeps the sessions' thread busy.
TEST(EmergencyStop, NeedsNoThreadOfTheSessions) {
  std::atomic<bool> holds{true}, held{false};
  DaemonOptions options;
  options.session_silence = 0ms;
  options.stuck_node = [&] {
    held = true;
    for (auto until = std::chrono::steady_clock::now() + kBound;
         holds && std::chrono::steady_clock::now() < until;)
      std::this_thread::sleep_for(1ms);
    return StuckNode{};
  };
  RunningDaemon daemon(scene::ClockKind::kRealtime, options);
  auto client = daemon.connect("curious", Role::kObserver);
  const auto asked = client.send(Status{});
  while (!held) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(stop(daemon).state, StopNews::State::kActed);
  EXPECT_TRUE(holds) << "no session was served meanwhile";
  holds = false;
  client.wait(asked);
}

// The sessions are held up for a second in real time: the part that one of them commands stops by itself.
TEST(SilentSessions, StopThePartsThatTheyCommand) {
  std::atomic<bool> slow{false};
  DaemonOptions options;
  options.session_silence = 250ms;
  options.stuck_node = [&] {
    if (slow.exchange(false)) std::this_thread::sleep_for(1s);
    return StuckNode{};
  };
  RunningDaemon daemon(scene::ClockKind::kRealtime, options);
  auto controller = daemon.connect("controller");
  controller.request(AcquireLease{"arm"});
  auto curious = daemon.connect("curious", Role::kObserver);
  EXPECT_EQ(curious.request_as<ServerStatus>(Status{}).silent_stops, 0u);
  slow = true;
  curious.request(Status{});
  EXPECT_EQ(curious.request_as<ServerStatus>(Status{}).silent_stops, 1u);
  std::optional<Reply> news;
  while ((news = controller.next(kBound)) && std::get<Event>(*news).kind != "lease_lost") {
  }
  ASSERT_TRUE(news);
  EXPECT_NE(std::get<Event>(*news).text.find("could not be heard"), std::string::npos);
  EXPECT_EQ(refusal_of([&] { controller.request(Write{"arm", 0, {0.1}}); }).code(), ErrorCode::kNoLease);
}

// In a session the stop goes the same way, past the commands that wait.
class StopInASession : public ::testing::Test {
 protected:
  bool stopped() {
    for (const auto& parameter : rig.simulation.parts()[0].part->parameters())
      if (parameter.name == kEmergencyStop) return std::get<bool>(parameter.value);
    return false;
  }
  GatewayRig rig{scene::ClockKind::kRealtime};
  NotedSession& admin = rig.connect("admin", Role::kAdmin);
  NotedSession& observer = rig.connect("observer", Role::kObserver);
};

TEST_F(StopInASession, IsAnsweredOnceItHasActed) {
  const auto id = rig.ask(observer, SetParameter{"arm", kEmergencyStop, true});
  EXPECT_TRUE(observer.replies.empty());
  rig.tick_side.empty_mailbox();
  EXPECT_TRUE(stopped());
  rig.tell();
  ASSERT_EQ(observer.replies.size(), 1u);
  EXPECT_EQ(observer.replies[0].first, id);
  EXPECT_EQ(std::get<Ok>(observer.replies[0].second).acts_at_tick, 0);
}

TEST_F(StopInASession, FindsRoomWhereTheCommandsAreFull) {
  for (std::size_t i = 0; i < Mailbox::kCommands; ++i)
    rig.ask(rig.connect("flood" + std::to_string(i), Role::kAdmin), SetSpeed{2.0});
  rig.ask(observer, SetParameter{"arm", kEmergencyStop, true});
  EXPECT_TRUE(observer.replies.empty()) << "not refused as busy";
  rig.tick_side.empty_mailbox();
  EXPECT_TRUE(stopped());
}

TEST_F(StopInASession, ActsBeforeTheRequestsOfItsOwnClientThatWait) {
  rig.ask(admin, Step{1'000'000});
  rig.ask(admin, SetParameter{"arm", kEmergencyStop, true});
  rig.tick_side.empty_mailbox();
  EXPECT_TRUE(stopped());
}

TEST_F(StopInASession, OutlivesAResetThatWasOnItsWay) {
  rig.ask(admin, Reset{});
  rig.ask(observer, SetParameter{"arm", kEmergencyStop, true});
  rig.tick_side.empty_mailbox();
  EXPECT_EQ(rig.simulation.era(), 2u);
  EXPECT_TRUE(stopped());
}

TEST_F(StopInASession, IsAcknowledgedWhileATickTakesLongAndSoIsAPause) {
  rig.ask(observer, SetParameter{"arm", kEmergencyStop, true});
  rig.ask(admin, Pause{});
  rig.gateway.beat();
  EXPECT_TRUE(observer.replies.empty());
  std::this_thread::sleep_for(visum::gateway::Commands::kPatience);
  rig.gateway.beat();
  for (auto* session : {&observer, &admin}) {
    ASSERT_EQ(session->replies.size(), 1u);
    EXPECT_EQ(std::get<Ok>(session->replies[0].second).acts_at_tick, rig.simulation.tick_count() + 1);
  }
  rig.ask(admin, Status{});
  EXPECT_EQ(admin.replies.size(), 2u) << "it waits no longer";
  rig.tick_side.empty_mailbox();
  rig.tell();
  EXPECT_TRUE(stopped());
  EXPECT_TRUE(rig.tick_side.pace().paused);
  EXPECT_EQ(admin.replies.size(), 2u) << "the result of the pause is not told again";
  EXPECT_EQ(observer.replies.size(), 1u);
}

}  // namespace
}  // namespace visum::gateway
