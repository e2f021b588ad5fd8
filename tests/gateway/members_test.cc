#include "server/gateway/members.h"

#include <gtest/gtest.h>

namespace visum::gateway {
namespace {

using namespace std::chrono_literals;
const Member::Clock::time_point kNow{1h};

TEST(Members, LetTheWorldRunAsFarAsTheSlowest) {
  Members members;
  members.join(1, "a", 0, 0s).granted_tick = 10;
  members.join(2, "b", 0, 0s).granted_tick = 25;
  EXPECT_EQ(members.limit(), 10);
  EXPECT_TRUE(members.leave(1));
  EXPECT_EQ(members.limit(), 25);
  EXPECT_FALSE(members.leave(1));
}

TEST(Members, KnowWhoWaitsForTheNearestTick) {
  Members members;
  members.join(1, "a", 0, 0s).granted_tick = 10;
  auto& b = members.join(2, "b", 0, 0s);
  EXPECT_FALSE(members.next_answer());
  b.granted_tick = 25;
  b.advance = 99;
  EXPECT_EQ(members.next_answer(), 25);
}

TEST(Members, NameWhoIsWaitedForTooLong) {
  Members members;
  members.join(1, "patient", 0, 0s);
  members.join(2, "slow", 0, 10s);
  auto& ahead = members.join(3, "ahead", 0, 1s);
  ahead.granted_tick = 5;
  ahead.advance = 1;
  EXPECT_EQ(members.waited_too_long(0, kNow), nullptr) << "the wait begins now";
  EXPECT_EQ(members.waited_too_long(0, kNow + 9s), nullptr);
  const auto* late = members.waited_too_long(0, kNow + 11s);
  ASSERT_NE(late, nullptr);
  EXPECT_EQ(late->client, "slow") << "no time-out for the first, no wait for the third";
}

TEST(Members, WhoeverIsAloneHasNoTimeOut) {
  Members members;
  members.join(1, "in a debugger", 0, 1s);
  members.waited_too_long(0, kNow);
  EXPECT_EQ(members.waited_too_long(0, kNow + 60s), nullptr);
  EXPECT_EQ(members.find(1)->waited_since, kNow) << "but Status tells since when";
}

TEST(Members, WhoAskedForATimeOutHasItAlsoWhereHeIsAlone) {
  Members members;
  members.join(1, "alone", 0, 1s).own_timeout = true;
  members.waited_too_long(0, kNow);
  EXPECT_EQ(members.waited_too_long(0, kNow + 900ms), nullptr);
  EXPECT_EQ(members.waited_too_long(0, kNow + 2s), members.find(1));
}

TEST(Members, WhoMayHoldTheWorldHasNoTimeOut) {
  Members members;
  members.join(1, "holds", 0, 1s).on_timeout = protocol::OnTimeout::kHold;
  members.join(2, "ahead", 0, 1s).granted_tick = 5;
  members.waited_too_long(0, kNow);
  EXPECT_EQ(members.waited_too_long(0, kNow + 60s), nullptr);
}

TEST(Members, AStepEndsTheWait) {
  Members members;
  members.join(1, "waiting", 0, 0s).advance = 1;
  members.find(1)->granted_tick = 9;
  auto& slow = members.join(2, "slow", 0, 10s);
  members.waited_too_long(0, kNow);
  slow.granted_tick = 1;
  members.waited_too_long(0, kNow + 5s);
  EXPECT_EQ(members.waited_too_long(1, kNow + 11s), nullptr);
}

TEST(Members, WhileTimeStandsNobodyIsWaitedFor) {
  Members members;
  members.join(1, "slow", 0, 10s);
  members.join(2, "ahead", 0, 10s).granted_tick = 5;
  members.waited_too_long(0, kNow);
  members.end_waits();
  EXPECT_EQ(members.waited_too_long(0, kNow + 60s), nullptr) << "the wait begins anew";
  EXPECT_EQ(members.waited_too_long(0, kNow + 71s), members.find(1));
}

TEST(Members, AllStandAtTheTickOfARestoredWorld) {
  Members members;
  members.join(1, "a", 0, 0s).granted_tick = 10;
  members.rebase(3);
  EXPECT_EQ(members.limit(), 3);
}

}  // namespace
}  // namespace visum::gateway
