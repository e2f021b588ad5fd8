// Pause, step, speed, reset, snapshots; the clocks realtime and free.
#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <system_error>
#include <thread>

#include "tests/gateway/running_daemon.h"
#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

using namespace protocol;

ServerStatus status_of(Connection& client) {
  return client.request_as<ServerStatus>(Status{});
}

TEST(Time, StandsUntilTheFirstLease) {
  RunningDaemon daemon(scene::ClockKind::kRealtime);
  auto client = daemon.connect("controller");
  EXPECT_TRUE(status_of(client).paused);
  EXPECT_EQ(status_of(client).tick, 0);
  client.request(AcquireLease{"arm", 0, false});
  client.request(Join{});
  EXPECT_GE(advance(client, 5).tick, 5);
  client.request(ReleaseLease{"arm"});
}

TEST(Time, StepsExactlyWhilePaused) {
  RunningDaemon daemon(scene::ClockKind::kRealtime);
  auto admin = daemon.connect("admin", Role::kAdmin);
  EXPECT_EQ(admin.request_as<Advanced>(Step{25}).tick, 25);
  EXPECT_EQ(admin.request_as<Advanced>(Step{1}).tick, 26);
  admin.request(Resume{});
  EXPECT_EQ(refusal_of([&] { admin.request(Step{1}); }).code(), ErrorCode::kWrongState);
  admin.request(Pause{});
  const auto tick = status_of(admin).tick;
  EXPECT_TRUE(status_of(admin).paused);
  EXPECT_EQ(admin.request_as<Advanced>(Step{3}).tick, tick + 3);
}

// Not every machine allows it: the daemon either does so, or says why not.
TEST(Time, TicksStandBeforeOrdinaryProgramsIfAsked) {
  const sched_param wanted{7}, ordinary{0};
  std::atomic<int> policy{-1}, priority{-1}, others{-1};
  DaemonOptions options;
  options.realtime_priority = wanted.sched_priority;
  options.run_at_once = true;
  options.wait = [&](std::chrono::steady_clock::time_point due) {
    sched_param now{};
    sched_getparam(0, &now);
    priority = now.sched_priority;
    policy = sched_getscheduler(0);
    std::thread([&] { others = sched_getscheduler(0); }).join();
    std::this_thread::sleep_until(due);
  };
  if (sched_setscheduler(0, SCHED_FIFO, &wanted) != 0) {
    EXPECT_THROW(RunningDaemon(scene::ClockKind::kRealtime, options), std::system_error);
    return;
  }
  ASSERT_EQ(sched_setscheduler(0, SCHED_OTHER, &ordinary), 0);
  {
    RunningDaemon daemon(scene::ClockKind::kRealtime, options);
    auto client = daemon.connect("observer", Role::kObserver);
    for (int i = 0; i < 10'000 && status_of(client).tick < 3; ++i) std::this_thread::yield();
    EXPECT_GE(status_of(client).tick, 3);
  }
  EXPECT_EQ(policy & ~SCHED_RESET_ON_FORK, SCHED_FIFO);
  EXPECT_EQ(priority, 7);
  EXPECT_EQ(others, SCHED_OTHER);
  EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
  EXPECT_THROW(RunningDaemon(scene::ClockKind::kLockstep, options), std::runtime_error);
}

// A world that was rewound does not begin with tick 0.
TEST(Time, AnEndAfterSoManyTicksCountsThoseThatAreMade) {
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
  scene.clock = scene::ClockKind::kFree;
  cycle::Simulation simulation(std::move(scene));
  for (int i = 0; i < 30; ++i) simulation.tick();
  DaemonOptions options;
  options.port = 0;
  options.run_at_once = true;
  options.iterations = 20;
  Daemon(simulation, options).run();
  EXPECT_EQ(simulation.tick_count(), 50);
}

TEST(Time, ReadsAreAnsweredWhilePaused) {
  RunningDaemon daemon(scene::ClockKind::kRealtime);
  auto reader = daemon.connect("reader", Role::kObserver);
  EXPECT_EQ(reader.request_as<PartSample>(Read{"arm"}).tick, 0);
  reader.request(Subscribe{"arm", 10});
  const auto first = reader.next(std::chrono::seconds(5));
  ASSERT_TRUE(first && std::holds_alternative<PartSample>(*first));
  EXPECT_EQ(std::get<PartSample>(*first).tick, 0);
}

TEST(Time, SamplesComeEveryNTicks) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto reader = daemon.connect("reader", Role::kObserver);
  auto stepper = daemon.connect("stepper");
  stepper.request(Join{});
  reader.request(Subscribe{"arm", 25});
  reader.request(SubscribeWorld{50});
  std::vector<std::int64_t> ticks, world_ticks;
  for (int i = 0; i < 10; ++i) {
    advance(stepper, 10);
    reader.request(Status{});
    while (const auto sample = reader.next(std::chrono::milliseconds(0))) {
      if (const auto* part = std::get_if<PartSample>(&*sample)) ticks.push_back(part->tick);
      if (const auto* world = std::get_if<WorldSample>(&*sample)) world_ticks.push_back(world->tick);
    }
  }
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 25, 50, 75, 100}));
  EXPECT_EQ(world_ticks, (std::vector<std::int64_t>{0, 50, 100}));
}

TEST(Time, TheSpeedIsOfTheClockRealtimeAndWithinBounds) {
  RunningDaemon realtime(scene::ClockKind::kRealtime);
  auto admin = realtime.connect("admin", Role::kAdmin);
  admin.request(SetSpeed{20.0});
  EXPECT_EQ(status_of(admin).speed, 20.0);
  for (double bad : {0.0, -1.0, 1e9, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(refusal_of([&] { admin.request(SetSpeed{bad}); }).code(), ErrorCode::kBadValue) << bad;
  RunningDaemon lockstep(scene::ClockKind::kLockstep);
  auto other = lockstep.connect("admin", Role::kAdmin);
  EXPECT_EQ(refusal_of([&] { other.request(SetSpeed{2.0}); }).code(), ErrorCode::kWrongState);
}

TEST(Time, ALongTickHoldsUpNoRequest) {
  const test::TempFiles files;
  const auto scene = files.write("slow.yaml", "{visum: 1, tick_ms: 10}");
  RunningDaemon daemon(scene.string(), scene::ClockKind::kRealtime, {}, 1e-3);
  auto admin = daemon.connect("admin", Role::kAdmin);
  admin.request(Resume{});
  EXPECT_EQ(admin.request_as<SnapshotTaken>(TakeSnapshot{}).tick, 0) << "the first tick is 10 s away";
  admin.request(Pause{});
  EXPECT_TRUE(status_of(admin).paused);
  admin.request(Resume{});
  admin.request(SetSpeed{1000.0});  // makes the tick come at once
  admin.request(Join{});
  EXPECT_GE(advance(admin, 5).tick, 5);
}

TEST(Time, TheFirstLeaseIsSeenInTheStatus) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("controller");
  EXPECT_TRUE(status_of(client).paused);
  client.request(AcquireLease{"arm", 0, false});
  for (int looks = 0; looks < 100 && status_of(client).paused; ++looks) {
  }
  EXPECT_FALSE(status_of(client).paused);
  EXPECT_EQ(status_of(client).tick, 0);
}

TEST(Time, SnapshotsComeBackToTheBitInANewEra) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto admin = daemon.connect("admin", Role::kAdmin);
  admin.request(Join{});
  admin.request(AcquireLease{"arm", 0, false});
  admin.request(Write{"arm", 0, {0.3}, 0});
  advance(admin, 100);
  const auto taken = admin.request_as<SnapshotTaken>(TakeSnapshot{});
  EXPECT_EQ(taken.tick, 100);
  advance(admin, 100);
  const auto later = state_hash(admin);
  admin.request(RestoreSnapshot{taken.snapshot});
  EXPECT_EQ(state_hash(admin), taken.state_hash);
  const auto moved = advance(admin, 100);
  EXPECT_EQ(moved.era, 2u);
  EXPECT_EQ(moved.tick, 200);
  EXPECT_EQ(state_hash(admin), later);
  EXPECT_EQ(refusal_of([&] { admin.request(RestoreSnapshot{999}); }).code(), ErrorCode::kUnknownName);
}

TEST(Time, ResetGoesBackToTheBeginning) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto admin = daemon.connect("admin", Role::kAdmin);
  admin.request(Join{});
  const auto first = state_hash(admin);
  advance(admin, 50);
  admin.request(Reset{});
  EXPECT_EQ(state_hash(admin), first);
  EXPECT_EQ(advance(admin, 5).tick, 5);
}

TEST(Time, FreeRunsAsFastAsItGoesAndNobodyHoldsIt) {
  RunningDaemon daemon(scene::ClockKind::kFree);
  auto idle = daemon.connect("idle");
  auto client = daemon.connect("controller");
  idle.request(Join{});
  client.request(AcquireLease{"arm", 0, false});
  client.request(Join{});
  EXPECT_GE(advance(client, 100).tick, 100) << "the idle member holds nobody";
  client.request(ReleaseLease{"arm"});
}

TEST(Time, ANonAdminMayNotTouchIt) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto controller = daemon.connect("controller"), observer = daemon.connect("observer", Role::kObserver);
  EXPECT_EQ(refusal_of([&] { controller.request(Reset{}); }).code(), ErrorCode::kForbidden);
  EXPECT_EQ(refusal_of([&] { observer.request(Join{}); }).code(), ErrorCode::kForbidden);
  EXPECT_EQ(refusal_of([&] {
              observer.request(AcquireLease{"arm", 0, false});
            }).code(),
            ErrorCode::kForbidden);
}

}  // namespace
}  // namespace visum::gateway
