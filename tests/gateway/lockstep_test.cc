// Lockstep: the tick waits for each client that joined, and the bits are the same in whatever order bytes
// come.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;

TEST(Lockstep, TimeStandsUntilTheClientSteps) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("stepper");
  EXPECT_EQ(client.request_as<Advanced>(Join{}).tick, 0);
  EXPECT_EQ(advance(client, 10).tick, 10);
  EXPECT_EQ(client.request_as<ServerStatus>(Status{}).tick, 10);
  EXPECT_EQ(advance(client, 7).sim_time_ns, 17'000'000);
}

TEST(Lockstep, RequestsThatComeTogetherDoNotWaitForEachOther) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("hasty");
  const std::vector<Request> requests(30, GetParameters{"arm"});
  auto fastest = std::chrono::steady_clock::duration::max();
  for (int k = 0; k < 5; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    for (const auto id : client.send_together(requests))
      EXPECT_TRUE(std::holds_alternative<ParameterList>(client.wait(id)));
    fastest = std::min(fastest, std::chrono::steady_clock::now() - begin);
  }
  EXPECT_LT(fastest, std::chrono::milliseconds(300))
      << "they took 477 ms while each waited for the one before";
}

TEST(Lockstep, TheSlowestHoldsTheWorld) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto fast = daemon.connect("fast"), slow = daemon.connect("slow");
  fast.request(Join{});
  slow.request(Join{});
  const auto waiting = fast.send(Advance{100});
  EXPECT_EQ(advance(slow, 30).tick, 30);
  const auto status = slow.request_as<ServerStatus>(Status{});
  EXPECT_EQ(status.tick, 30);
  ASSERT_EQ(status.lockstep.size(), 2u);
  EXPECT_EQ(status.lockstep[0].client, "fast");
  EXPECT_EQ(status.lockstep[0].granted_tick, 100);
  slow.request(Leave{});
  EXPECT_EQ(std::get<Advanced>(fast.wait(waiting)).tick, 100);
}

Advance after_others(std::int64_t ticks, std::uint32_t members) {
  return Advance{ticks, false, 0, {}, members};
}

TEST(Lockstep, AMemberThatFollowsTheOthersLetsTheWorldRunOnlyOnceTheyDo) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto runner = daemon.connect("runner"), other = daemon.connect("other");
  runner.request(Join{});
  other.request(Join{});
  const auto ids = runner.send_together({after_others(10, 2), after_others(10, 2), after_others(10, 2)});
  EXPECT_FALSE(runner.wait_for(ids[0], std::chrono::milliseconds(50))) << "the other has not decided yet";
  EXPECT_EQ(advance(other, 10).tick, 10);
  EXPECT_EQ(std::get<Advanced>(runner.wait(ids[0])).tick, 10);
  EXPECT_EQ(advance(other, 20).tick, 30);
  EXPECT_EQ(std::get<Advanced>(runner.wait(ids[1])).tick, 20);
  EXPECT_EQ(std::get<Advanced>(runner.wait(ids[2])).tick, 30);
}

TEST(Lockstep, TheWorldStandsForAMemberThatFollowsTheOthersWhenOneLeaves) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto runner = daemon.connect("runner"), stays = daemon.connect("stays"), leaves = daemon.connect("leaves");
  for (auto* client : {&runner, &stays, &leaves}) client->request(Join{});
  const auto ids = runner.send_together({after_others(10, 3), after_others(10, 3), after_others(10, 3)});
  const auto long_one = stays.send(Advance{100});
  EXPECT_EQ(advance(leaves, 10).tick, 10);
  leaves.request(Leave{});
  for (const auto id : ids) EXPECT_EQ(std::get<Advanced>(runner.wait(id)).tick, 10);
  EXPECT_EQ(runner.request_as<ServerStatus>(Status{}).tick, 10);
  EXPECT_EQ(std::get<Advanced>(runner.request(after_others(90, 2))).tick, 100);
  EXPECT_EQ(std::get<Advanced>(stays.wait(long_one)).tick, 100);
}

TEST(Lockstep, MembersThatFollowTheOthersDoNotWaitForEachOther) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto one = daemon.connect("one"), two = daemon.connect("two");
  one.request(Join{});
  two.request(Join{});
  const auto first = one.send(after_others(10, 2)), second = two.send(after_others(10, 2));
  EXPECT_EQ(std::get<Advanced>(one.wait(first)).tick, 10);
  EXPECT_EQ(std::get<Advanced>(two.wait(second)).tick, 10);
}

TEST(Lockstep, FollowingTheOthersIsForLockstepAlone) {
  RunningDaemon daemon(scene::ClockKind::kFree);
  auto client = daemon.connect("client");
  client.request(Join{});
  EXPECT_EQ(refusal_of([&] { client.request(after_others(10, 1)); }).code(), ErrorCode::kBadValue);
}

TEST(Lockstep, AClientThatDiesNeverHangsTheWorld) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto survivor = daemon.connect("survivor");
  survivor.request(Join{});
  {
    auto doomed = daemon.connect("doomed");
    doomed.request(Join{});
  }
  EXPECT_EQ(advance(survivor, 10).tick, 10);
}

TEST(Lockstep, ATimeOutIsAnErrorThatNamesTheClient) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);  // 0.3 s
  auto waiting = daemon.connect("waiting"), asleep = daemon.connect("asleep");
  waiting.request(Join{});
  asleep.request(Join{});
  const auto error = refusal_of([&] { advance(waiting, 10); });
  EXPECT_EQ(error.code(), ErrorCode::kTimeout);
  EXPECT_NE(std::string(error.what()).find("'asleep'"), std::string::npos) << error.what();
  EXPECT_EQ(advance(waiting, 10).tick, 10) << "and the world goes on without it";
  EXPECT_EQ(refusal_of([&] { advance(asleep, 1); }).code(), ErrorCode::kWrongState);
}

TEST(Lockstep, APauseIsNoTimeThatAMemberLetsTheWorldWait) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);  // 0.3 s
  auto admin = daemon.connect("admin", Role::kAdmin);
  auto waiting = daemon.connect("waiting"), computing = daemon.connect("computing");
  waiting.request(Join{});
  computing.request(Join{});
  const auto reply = waiting.send(Advance{10});
  admin.request(Pause{});
  std::this_thread::sleep_for(std::chrono::milliseconds(350));
  admin.request(Resume{});
  EXPECT_EQ(admin.request_as<ServerStatus>(Status{}).lockstep.size(), 2u);
  EXPECT_EQ(advance(computing, 10).tick, 10);
  EXPECT_EQ(std::get<Advanced>(waiting.wait(reply)).tick, 10);
}

TEST(Lockstep, OthersGoOnWhereATimeOutIsToStopOrFreeItsClient) {
  for (const auto on_timeout : {protocol::OnTimeout::kStop, protocol::OnTimeout::kFree}) {
    RunningDaemon daemon(scene::ClockKind::kLockstep);  // 0.3 s
    auto waiting = daemon.connect("waiting"), asleep = daemon.connect("asleep");
    waiting.request(Join{});
    asleep.request(AcquireLease{"arm"});
    asleep.request(Join{0, 0, on_timeout});
    EXPECT_EQ(advance(waiting, 10).tick, 10);
    EXPECT_EQ(refusal_of([&] { advance(asleep, 1); }).code(), ErrorCode::kWrongState);
    const auto write = [&] { asleep.request(Write{"arm", 0, {0.0}}); };
    if (on_timeout == protocol::OnTimeout::kFree)
      EXPECT_NO_THROW(write());
    else
      EXPECT_EQ(refusal_of(write).code(), ErrorCode::kNoLease);
  }
}

constexpr double kControllerLost = 6.0;  // a value of the port Part State

// Joins with a time-out of its own, as `visum exec --wait` does.
Join late(OnTimeout on_timeout) {
  return {100'000'000, 2, on_timeout, {}, {"arm"}};
}

TEST(Lockstep, WhoIsAloneAndLateIsThrownOutWhereItAskedForThat) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto alone = daemon.connect("alone");
  alone.request(late(OnTimeout::kEnd));
  while (!alone.request_as<ServerStatus>(Status{}).lockstep.empty()) alone.next(std::chrono::milliseconds(1));
  EXPECT_EQ(refusal_of([&] { advance(alone, 1); }).code(), ErrorCode::kWrongState);
}

TEST(Lockstep, WhoGoesOnInRealTimeTakesTheWorldWithIt) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("dropped");
  client.request(Join{});
  advance(client, 1);
  client.request(Leave{});
  client.request(late(OnTimeout::kFree));
  while (client.request_as<ServerStatus>(Status{}).tick < 20) client.next(std::chrono::milliseconds(1));
  EXPECT_EQ(client.request_as<ServerStatus>(Status{}).free_running, std::vector<std::string>{"dropped"});
}

TEST(Lockstep, PartsThatAreCommandedByTheirBusesStopToo) {
  for (const auto on_timeout : {OnTimeout::kEnd, OnTimeout::kStop, OnTimeout::kFree}) {
    RunningDaemon daemon(scene::ClockKind::kLockstep);
    auto waiting = daemon.connect("waiting"), asleep = daemon.connect("asleep");
    waiting.request(Join{});
    asleep.request(late(on_timeout));
    const auto first = waiting.send(Advance{10});
    try {
      waiting.wait(first);
    } catch (const RequestError&) {  // kEnd
    }
    advance(waiting, 10);
    const bool stopped = sensor(waiting, "Part State") == kControllerLost;
    EXPECT_EQ(stopped, on_timeout != OnTimeout::kFree) << static_cast<int>(on_timeout);
  }
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("confused");
  EXPECT_EQ(refusal_of([&] {
              client.request(Join{0, 2, OnTimeout::kEnd, {}, {"leg"}});
            }).code(),
            ErrorCode::kUnknownName);
}

TEST(Lockstep, WhatAnotherLeasesIsHisWhoeverIsLate) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto owner = daemon.connect("owner"), asleep = daemon.connect("asleep");
  owner.request(AcquireLease{"arm", 0, false});
  owner.request(Join{});
  asleep.request(late(OnTimeout::kStop));
  advance(owner, 10);
  owner.request(Write{"arm", 0, {0.1}, 0});
  advance(owner, 10);
  EXPECT_EQ(owner.request_as<PartSample>(Read{"arm"}).controller_inputs[0], 0.1);
  EXPECT_NE(sensor(owner, "Part State"), kControllerLost);
}

TEST(Lockstep, PartsThatAreCommandedByTheirBusesStopWhereTheConnectionEnds) {
  for (const bool in_good_order : {false, true}) {
    RunningDaemon daemon(scene::ClockKind::kLockstep);
    auto waiting = daemon.connect("waiting");
    waiting.request(Join{});
    {
      auto gone = daemon.connect("gone");
      gone.request(Join{0, 2, OnTimeout::kEnd, {}, {"arm"}});
      if (in_good_order) gone.request(Leave{});
    }
    advance(waiting, 10);
    EXPECT_EQ(sensor(waiting, "Part State") == kControllerLost, !in_good_order);
  }
}

TEST(Lockstep, StepsNeedAJoinAndSaneNumbers) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("confused");
  EXPECT_EQ(refusal_of([&] { advance(client, 1); }).code(), ErrorCode::kWrongState);
  client.request(Join{});
  EXPECT_EQ(refusal_of([&] { client.request(Join{}); }).code(), ErrorCode::kWrongState);
  for (std::int64_t ticks : {std::int64_t{0}, std::int64_t{-1}, std::numeric_limits<std::int64_t>::max(),
                             std::numeric_limits<std::int64_t>::min()})
    EXPECT_EQ(refusal_of([&] { advance(client, ticks); }).code(), ErrorCode::kBadValue) << ticks;
}

// One run of two clients with different periods; `swapped`: the other one connects and writes first.
std::uint64_t run_of_two(bool swapped) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto mover = daemon.connect(swapped ? "pusher" : "mover", Role::kAdmin);
  auto pusher = daemon.connect(swapped ? "mover" : "pusher", Role::kAdmin);
  if (swapped) std::swap(mover, pusher);
  mover.request(Join{});
  pusher.request(Join{});
  mover.request(AcquireLease{"arm", 0, false});
  for (int i = 0; i < 20; ++i) {
    const auto push = [&] { pusher.request(PushBody{"box", {0.1 * i, 0, 0}, {}, {}, 3'000'000}); };
    const auto push_too = [&] { mover.request(PushBody{"box", {0, 0.3, 0.01 * i}, {}, {}, 2'000'000}); };
    const auto write = [&] { mover.request(Write{"arm", 0, {0.01 * i}, 0}); };
    if (swapped)
      push(), write(), push_too();
    else
      write(), push_too(), push();
    const auto reply = mover.send(Advance{10});
    advance(pusher, 10);
    mover.wait(reply);
  }
  return state_hash(mover);
}

TEST(Lockstep, TheOrderOfBytesDoesNotChangeTheBits) {
  EXPECT_EQ(run_of_two(false), run_of_two(true));
}

// The same inputs at the same ticks, one connection, different granularity of steps.
std::uint64_t run_in_steps_of(std::int64_t step) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("stepper");
  client.request(Join{});
  client.request(AcquireLease{"arm", 0, false});
  for (int i = 0; i < 5; ++i) {
    client.request(Write{"arm", 0, {0.05 * i, -0.02 * i}, 0});
    for (std::int64_t done = 0; done < 60; done += step) advance(client, step);
  }
  return state_hash(client);
}

TEST(Lockstep, ReadingMoreOftenDoesNotChangeTheBits) {
  const auto hash = run_in_steps_of(60);
  EXPECT_EQ(run_in_steps_of(1), hash);
  EXPECT_EQ(run_in_steps_of(12), hash);
}

}  // namespace
}  // namespace visum::gateway
