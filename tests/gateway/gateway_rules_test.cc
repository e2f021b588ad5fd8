// The sessions' side when requests cross with news from the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/gateway/gateway_rig.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using scene::ClockKind;

constexpr std::int64_t kDeadline_ns = 5'000'000;  // 5 ticks

// How many times the session was told "lease_lost".
std::size_t losses_told_to(const NotedSession& session) {
  return static_cast<std::size_t>(std::ranges::count(session.events, "lease_lost", &Event::kind));
}

std::vector<std::uint64_t> answered(const NotedSession& session) {
  std::vector<std::uint64_t> ids;
  for (const auto& [id, reply] : session.replies) ids.push_back(id);
  return ids;
}

TEST(Backlog, IsAnsweredAsFarAsThereIsRoomAndInOrder) {
  GatewayRig rig(ClockKind::kLockstep);
  auto& client = rig.connect("client");
  std::vector<std::uint64_t> ids{rig.ask(client, GetParameters{"arm"})};
  for (int i = 0; i < 5; ++i) ids.push_back(rig.ask(client, Read{"arm"}));
  client.room = 3;
  rig.tick_side.empty_mailbox();
  rig.tell();
  EXPECT_EQ(client.replies.size(), 3u) << "the one that waited, and two behind it";
  rig.tell();
  EXPECT_EQ(client.replies.size(), 3u);
  ids.push_back(rig.ask(client, Status{}));
  client.room = 100;
  rig.gateway.on_room(client);
  EXPECT_EQ(answered(client), ids);
}

TEST(Backlog, IsWorkedOffWhereItsClientSaysGoodbye) {
  GatewayRig rig(ClockKind::kRealtime);
  auto& observer = rig.connect("observer", Role::kObserver);
  auto& script = rig.connect("script");
  rig.ask(script, AcquireLease{"arm"});
  rig.ask(script, GetParameters{"arm"});
  rig.ask(script, Write{"arm", 0, {0.25}, 0});
  rig.ask(script, ReleaseLease{"arm"});
  rig.leave(script, CloseReason::kGoodbye);
  rig.tick();
  rig.tell();
  EXPECT_EQ(rig.input(0), 0.25);
  EXPECT_EQ(losses_told_to(observer), 0u);
}

TEST(Backlog, BehindAnAdvanceWaitsForNoTickAtAGoodbye) {
  GatewayRig rig(ClockKind::kLockstep);
  auto& observer = rig.connect("observer", Role::kObserver);
  auto& script = rig.connect("script");
  rig.ask(script, AcquireLease{"arm"});
  rig.ask(script, Join{});
  rig.ask(script, Advance{10});
  rig.ask(script, Write{"arm", 0, {0.25}, 0});
  rig.ask(script, Advance{10});
  rig.ask(script, ReleaseLease{"arm"});
  rig.leave(script, CloseReason::kGoodbye);
  rig.tick();
  rig.tell();
  EXPECT_EQ(rig.input(0), 0.25);
  EXPECT_EQ(losses_told_to(observer), 0u);
}

TEST(Backlog, OfWhoIsLostIsNotDone) {
  GatewayRig rig(ClockKind::kRealtime);
  auto& observer = rig.connect("observer", Role::kObserver);
  auto& script = rig.connect("script");
  rig.ask(script, AcquireLease{"arm"});
  rig.ask(script, GetParameters{"arm"});
  rig.ask(script, ReleaseLease{"arm"});
  rig.leave(script, CloseReason::kLost);
  rig.tick();
  rig.tell();
  EXPECT_EQ(losses_told_to(observer), 1u);
}

TEST(FullMailbox, RefusesNoWriteAndNoRelease) {
  for (const auto clock : {ClockKind::kLockstep, ClockKind::kFree}) {
    GatewayRig rig(clock);
    auto& admin = rig.connect("admin", Role::kAdmin);
    auto& client = rig.connect("client");
    rig.ask(client, AcquireLease{"arm"});
    const auto push = [&] { rig.ask(admin, PushBody{"box", {0, 0, 1}, {}, {}, 1'000'000}); };
    do push();
    while (!std::holds_alternative<Error>(admin.replies.back().second));
    rig.answer<Ok>(client, Write{"arm", 0, {0.25}, 0});
    rig.answer<Ok>(client, Write{"arm", 0, {0.5}, 0});
    rig.answer<Ok>(client, ReleaseLease{"arm"});
    rig.ask(admin, Pause{});
    rig.tick_side.empty_mailbox();
    rig.tell();
    EXPECT_TRUE(std::holds_alternative<Ok>(admin.replies.back().second)) << "time can be held";
    rig.tick();
    EXPECT_EQ(rig.input(0), 0.5);
  }
}

TEST(MissedDeadline, IsToldAlsoWhereTheLeaseWasGrantedAnewBeforeTheWordOfIt) {
  GatewayRig rig(ClockKind::kRealtime);
  auto& observer = rig.connect("observer", Role::kObserver);
  auto& client = rig.connect("client");
  rig.ask(client, AcquireLease{"arm", kDeadline_ns, false});
  for (int i = 0; i < 20; ++i) rig.tick();
  EXPECT_EQ(rig.answer<LeaseGrant>(client, AcquireLease{"arm"}).epoch, 2u);
  rig.tell();
  EXPECT_EQ(losses_told_to(observer), 1u);
  EXPECT_EQ(rig.gateway.metrics().lease_losses, 1u);
  rig.answer<Ok>(client, Write{"arm", 0, {0.25}, 0});
  rig.tick();
  EXPECT_EQ(rig.input(0), 0.25);
}

TEST(MissedDeadline, IsToldAlsoWhereTheLeaseWasReleasedBeforeTheWordOfIt) {
  GatewayRig rig(ClockKind::kRealtime);
  auto& observer = rig.connect("observer", Role::kObserver);
  auto& client = rig.connect("client");
  rig.ask(client, AcquireLease{"arm", kDeadline_ns, false});
  for (int i = 0; i < 20; ++i) rig.tick();
  rig.answer<Ok>(client, ReleaseLease{"arm"});
  rig.tell();
  EXPECT_EQ(losses_told_to(observer), 1u);
}

TEST(MissedDeadline, OfALeaseWhoseLossWasToldIsNotToldAgain) {
  GatewayRig rig(ClockKind::kRealtime);
  auto& observer = rig.connect("observer", Role::kObserver);
  auto& client = rig.connect("client");
  auto& admin = rig.connect("admin", Role::kAdmin);
  rig.ask(client, AcquireLease{"arm", kDeadline_ns, false});
  for (int i = 0; i < 20; ++i) rig.tick();
  rig.answer<LeaseGrant>(admin, AcquireLease{"arm", 0, true});
  rig.tell();
  EXPECT_EQ(losses_told_to(observer), 1u);
  EXPECT_EQ(rig.gateway.metrics().lease_losses, 1u);
}

// With ticks of a microsecond, a second is a million ticks.
TEST(NetworkDelay, OfMoreTicksThanThereIsRoomForIsRefused) {
  GatewayRig rig(ClockKind::kLockstep, 1'000);
  auto& admin = rig.connect("admin", Role::kAdmin);
  const auto refusal = rig.answer<Error>(admin, InjectFault{"arm", "network_delay", {{"ms", 1000}}, 0});
  EXPECT_EQ(refusal.code, ErrorCode::kBadValue);
  EXPECT_NE(refusal.text.find("ticks under way"), std::string::npos) << refusal.text;
  rig.answer<Ok>(admin, InjectFault{"arm", "network_delay", {{"ms", 10}}, 0});
}

// Both fingers have one drive: their inputs must be equal.
TEST(MissedDeadline, LeavesNothingBehindThatNeverCameIntoForce) {
  GatewayRig rig(ClockKind::kRealtime);
  const auto& ports = rig.simulation.parts()[0].part->description().controller_inputs;
  const auto left = static_cast<std::uint32_t>(std::ranges::find(ports, "m", &Port::unit) - ports.begin());
  const double before = rig.input(left), other = ports.at(left).maximum;
  ASSERT_EQ(ports.at(left + 1).unit, "m");
  ASSERT_GT(std::abs(before - other), 0.01);
  auto& client = rig.connect("client");
  auto& next = rig.connect("next");
  rig.ask(client, AcquireLease{"arm", kDeadline_ns, false});
  for (int i = 0; i < 20; ++i) rig.tick();
  rig.answer<Ok>(client, Write{"arm", left, {other, other}, 0});
  rig.tell();
  rig.tick();
  ASSERT_EQ(rig.input(left), before) << "too late to be done";
  rig.answer<LeaseGrant>(next, AcquireLease{"arm"});
  EXPECT_EQ(rig.answer<Error>(next, Write{"arm", left, {other}, 0}).code, ErrorCode::kBadValue);
  rig.answer<Ok>(next, Write{"arm", left, {before}, 0});
}

TEST(Replies, OfStepsThatWereSentAheadMayLeaveTogether) {
  GatewayRig rig(ClockKind::kLockstep);
  auto& client = rig.connect("client");
  rig.answer<Advanced>(client, Join{});
  const auto step = [&](bool may_wait) {
    rig.ask(client, Advance{1, false, 0, {}, 0, may_wait});
    EXPECT_TRUE(client.holds_back) << "replies before it wait for its own";
    rig.ask(client, Read{"arm"});
    const auto before = client.replies.size();
    rig.tick();
    rig.tell();
    EXPECT_EQ(client.replies.size(), before + 2);
    return client.holds_back;
  };
  EXPECT_TRUE(step(true));
  EXPECT_TRUE(step(true));
  EXPECT_FALSE(step(false));
  EXPECT_FALSE(step(false));
}

TEST(Replies, AreNotHeldBackInRealTime) {
  GatewayRig rig(ClockKind::kRealtime);
  auto& client = rig.connect("client");
  rig.answer<Advanced>(client, Join{});
  rig.ask(client, Advance{1});
  EXPECT_FALSE(client.holds_back);
}

}  // namespace
}  // namespace visum::gateway
