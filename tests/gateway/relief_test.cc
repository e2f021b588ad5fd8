// The sessions change hands between the tick's thread and its relief.
#include "server/gateway/relief.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace std::chrono_literals;

// Sessions that two threads serve in turn. They have no lock, so that the thread sanitizer sees whether the
// relief hands them over as it should.
class Sessions : public ::testing::Test {
 protected:
  Relief::Duties duties() {
    return {.relieve =
                [this](bool begins) {
                  EXPECT_NE(relieved, begins);
                  relieved = begins;
                  times += begins;
                },
            .serve =
                [this](std::chrono::nanoseconds at_most) {
                  EXPECT_TRUE(relieved);
                  ++served;
                  std::unique_lock lock(mutex);
                  woken.wait_for(lock, at_most, [this] { return wakes > 0; });
                },
            .wake =
                [this] {
                  const std::lock_guard lock(mutex);
                  ++wakes;
                  woken.notify_all();
                },
            .is_to_end = [this] { return to_end.load(); },
            .tick = [this] { return tick.load(); },
            .abandon = [this](std::uint64_t number) { abandoned = number; }};
  }
  bool relieved = false;
  int times = 0, served = 0;
  std::mutex mutex;
  std::condition_variable woken;
  int wakes = 0;
  std::atomic<bool> to_end{false};
  std::atomic<std::uint64_t> tick{0}, abandoned{0};
};

TEST_F(Sessions, StayWhereTheyAreWhileNothingTakesLong) {
  Relief relief(duties());
  const auto end = std::chrono::steady_clock::now() + 500ms;
  while (std::chrono::steady_clock::now() < end) {
    relief.leave();
    relief.take_back();
    ++served;
  }
}

TEST_F(Sessions, AreServedByTheReliefWhileSomethingTakesLongAndThenComeBack) {
  Relief relief(duties());
  for (int i = 1; i <= 3; ++i) {
    relief.leave();
    std::this_thread::sleep_for(600ms);
    EXPECT_TRUE(relief.take_back());
    EXPECT_FALSE(relieved);
    EXPECT_EQ(times, i);
    EXPECT_GE(served, i);
    const std::lock_guard lock(mutex);
    wakes = 0;
  }
}

TEST_F(Sessions, ATickThatDoesNotEndIsAbandonedOnlyWhenTheDaemonIsToEnd) {
  auto alone = duties();
  alone.relieve = nullptr;
  tick = 7;
  Relief relief(std::move(alone));
  std::this_thread::sleep_for(2500ms);
  EXPECT_EQ(abandoned, 0u);
  to_end = true;
  const auto patience = std::chrono::steady_clock::now() + 60s;
  while (abandoned == 0 && std::chrono::steady_clock::now() < patience) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(abandoned, 7u);
}

// A world whose third tick lasts until the test lets it end.
class LongTick : public cycle::Observer {
 public:
  explicit LongTick(scene::ClockKind clock) : simulation(scene_of(clock)) {
    simulation.set_observer(this);
    DaemonOptions options;
    options.port = 0;
    daemon = std::make_unique<Daemon>(simulation, options);
    thread = std::thread([this] { daemon->run(); });
  }
  ~LongTick() override {
    lasts = false;
    daemon->stop();
    thread.join();
  }
  void took(const recording::TimedInput&) override {}
  void ticked() override {
    if (simulation.tick_count() != 3) return;
    has_come = true;
    for (auto until = std::chrono::steady_clock::now() + 60s;
         lasts && std::chrono::steady_clock::now() < until;)
      std::this_thread::sleep_for(1ms);
  }
  protocol::Connection connect(const std::string& name) {
    return {"127.0.0.1", daemon->port(), {1, 1, name, protocol::Role::kAdmin, {}}};
  }
  static scene::Scene scene_of(scene::ClockKind clock) {
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
    scene.clock = clock;
    return scene;
  }

  cycle::Simulation simulation;
  std::unique_ptr<Daemon> daemon;
  std::thread thread;
  std::atomic<bool> lasts{true}, has_come{false};
};

TEST(ALongTick, HoldsUpNoSessionAndMembersOfTheLockstepWait) {
  using namespace protocol;
  for (const auto clock : {scene::ClockKind::kLockstep, scene::ClockKind::kFree}) {
    LongTick world(clock);
    auto member = world.connect("member"), client = world.connect("client");
    member.request(Join{});
    const auto advance = member.send(Advance{10});
    const auto asked = member.send(Status{});
    while (!world.has_come) std::this_thread::sleep_for(1ms);
    for (int i = 0; i < 20; ++i) {
      EXPECT_LT(client.request_as<ServerStatus>(Status{}).tick, 3);
      client.request(ReadWorld{});
      client.request(Read{"arm"});
    }
    client.request(AcquireLease{"arm"});
    client.request(Write{"arm", 0, {0.25}});
    world.connect("visitor").request(ListParts{});
    const auto joins = client.send(Join{});
    EXPECT_FALSE(client.wait_for(joins, 300ms)) << "a member stands at a tick border";
    EXPECT_FALSE(member.wait_for(asked, 1ms)) << "the requests of a session are answered in order";
    EXPECT_TRUE(world.lasts);
    auto pauser = world.connect("pauser");
    EXPECT_EQ(std::get<Ok>(pauser.request(Pause{})).acts_at_tick, 3);
    world.lasts = false;
    EXPECT_GE(std::get<Advanced>(client.wait(joins)).tick, 3);
    pauser.request(Resume{});
    client.request(Leave{});
    EXPECT_EQ(std::get<Advanced>(member.wait(advance)).tick >= 10, true);
    member.wait(asked);
    EXPECT_EQ(client.request_as<PartSample>(Read{"arm"}).controller_inputs[0], 0.25);
  }
}

}  // namespace
}  // namespace visum::gateway
