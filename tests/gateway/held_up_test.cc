// Threads that were held up: the sessions' thread as the tick's thread sees it, and commands that have become
// too old meanwhile.
#include <gtest/gtest.h>

#include "server/gateway/holdup.h"
#include "server/gateway/session_watch.h"
#include "tests/gateway/gateway_rig.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using namespace std::chrono_literals;

class Silence : public ::testing::Test {
 protected:
  Silence() {
    watch.set_limit(250ms);
    watch.look(1, now);
  }
  bool look(std::uint64_t beats, std::chrono::milliseconds passed) {
    return watch.look(beats, now += passed);
  }
  SessionWatch watch;
  SessionWatch::Clock::time_point now{1'000s};
};

TEST_F(Silence, IsToldOnceEachTime) {
  for (std::uint64_t silence = 2; silence < 8; silence += 2) {
    int told = 0;
    EXPECT_FALSE(look(silence, 20ms));
    for (int i = 0; i < 12; ++i) told += look(silence, 20ms);
    EXPECT_EQ(told, 0) << "240 ms";
    for (int i = 0; i < 100; ++i) told += look(silence, 20ms);
    EXPECT_EQ(told, 1);
    EXPECT_FALSE(look(silence + 1, 20ms));
  }
}

TEST_F(Silence, IsNotThatOfAProcessThatWasStopped) {
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(look(1, 1h));
}

TEST_F(Silence, WithoutALimitIsNone) {
  watch.set_limit(0ms);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(look(1, 20ms));
}

TEST(HoldupTest, LastsUntilAllIsReadThatHadWaited) {
  Holdup holdup;
  holdup.set_limit(200ms);
  Holdup::Clock::time_point now{1'000s};
  holdup.look(now);
  holdup.look(now += 200ms);
  EXPECT_EQ(holdup.age(), 0ms);
  holdup.look(now += 201ms);
  EXPECT_EQ(holdup.age(), 201ms);
  holdup.look(now += 1ms);
  EXPECT_EQ(holdup.age(), 201ms) << "the next request had waited, too";
  holdup.end();
  EXPECT_EQ(holdup.age(), 0ms);
}

class OldWrites : public ::testing::Test {
 protected:
  OldWrites() {
    rig.gateway.holdup().set_limit(200ms);
    rig.tick_side.drop_writes_older_than(200ms);
    rig.answer<LeaseGrant>(controller, AcquireLease{"arm"});
    rig.tick();
    rig.tell();
  }
  std::uint64_t late_writes() { return rig.answer<ServerStatus>(controller, Status{}).late_writes; }
  GatewayRig rig{scene::ClockKind::kRealtime};
  NotedSession& controller = rig.connect("controller");
};

TEST_F(OldWrites, AreRefusedWhereTheServerDidNotRun) {
  rig.gateway.beat();
  std::this_thread::sleep_for(201ms);
  const auto refused = rig.answer<Error>(controller, Write{"arm", 0, {0.25}});
  EXPECT_EQ(refused.code, ErrorCode::kStale);
  EXPECT_NE(refused.text.find("too old"), std::string::npos);
  rig.gateway.holdup().end();
  rig.tick();
  rig.tell();
  EXPECT_EQ(rig.input(0), 0.0);
  EXPECT_EQ(late_writes(), 1u);
  rig.answer<Ok>(controller, Write{"arm", 0, {0.125}});
  rig.tick();
  EXPECT_EQ(rig.input(0), 0.125);
}

TEST_F(OldWrites, AreDroppedWhereTheTickCameTooLate) {
  rig.answer<Ok>(controller, Write{"arm", 0, {0.25}});
  std::this_thread::sleep_for(201ms);
  rig.tick();
  rig.publish();
  rig.gateway.serve();
  EXPECT_EQ(rig.input(0), 0.0);
  EXPECT_EQ(rig.tick_side.dropped_writes(), 1u);
}

TEST_F(OldWrites, WaitForATimeThatStoodStill) {
  rig.answer<Ok>(controller, Write{"arm", 0, {0.25}});
  std::this_thread::sleep_for(201ms);
  rig.tick_side.go_on(std::chrono::steady_clock::now());
  rig.tick();
  EXPECT_EQ(rig.input(0), 0.25);
  EXPECT_EQ(rig.tick_side.dropped_writes(), 0u);
}

}  // namespace
}  // namespace visum::gateway
