// Islands on several threads: any number of them gives the same bits.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <numeric>
#include <thread>

#include "server/dynamics/impulse/island_pool.h"
#include "tests/dynamics/lab.h"
#include "tests/dynamics/model_builder.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/legged_models.h"

namespace visum::dynamics::testing {
namespace {

constexpr double kTick = 1e-3;

TEST(IslandPool, DoesEachThingOnce) {
  for (const int threads : {1, 2, 4, 64}) {
    impulse::IslandPool pool(threads);
    EXPECT_EQ(pool.threads(), static_cast<std::size_t>(threads));
    // Many rounds of all sizes, so that a thread that wakes late would be seen.
    std::vector<int> done(64, 0), by_worker(64, 0);
    for (std::size_t round = 0; round < 2000; ++round) {
      auto work = [&](std::size_t worker, std::size_t i) {
        ++done[i];
        ++by_worker[worker];
      };
      pool.run(
          round % 65, [&](std::size_t i) { return (i + round) % 7; }, work);
    }
    std::vector<int> expected(64, 0);
    for (std::size_t round = 0; round < 2000; ++round)
      for (std::size_t i = 0; i < round % 65; ++i) ++expected[i];
    EXPECT_EQ(done, expected);
    EXPECT_EQ(std::accumulate(by_worker.begin(), by_worker.end(), 0),
              std::accumulate(expected.begin(), expected.end(), 0));
  }
}

// Waits until the number has grown to `least`; false if it does not within ten seconds.
bool wait_for(const std::atomic<int>& number, int least) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (number < least) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST(IslandPool, BeginsWithSharesOfTheSameCost) {
  impulse::IslandPool pool(2);
  // One dear thing, and nine cheap ones. Each thread waits in its first until the other has begun, too.
  std::vector<int> first(2, -1);
  std::atomic<int> begun = 0;
  auto work = [&](std::size_t worker, std::size_t i) {
    if (first[worker] >= 0) return;
    first[worker] = static_cast<int>(i);
    ++begun;
    EXPECT_TRUE(wait_for(begun, 2));
  };
  pool.run(
      10, [](std::size_t i) { return i == 0 ? 9u : 1u; }, work);
  EXPECT_EQ(first, (std::vector<int>{0, 1}));
}

TEST(IslandPool, AThreadThatIsDoneHelpsTheOthers) {
  impulse::IslandPool pool(2);
  // The first thread's share is five things. It stays in the first one until all others are done.
  std::atomic<int> done = 0;
  auto work = [&](std::size_t, std::size_t i) {
    if (i == 0) {
      EXPECT_TRUE(wait_for(done, 9));
    }
    ++done;
  };
  pool.run(
      10, [](std::size_t) { return 1u; }, work);
  EXPECT_EQ(done, 10);
}

// A run leaves this, tick by tick: the state with the engine's memory, and what was told.
struct Run {
  std::vector<std::uint64_t> hashes;
  std::vector<std::uint64_t> work;
  int warned = 0, limited = 0;
  bool operator==(const Run&) const = default;
};

using Act = std::function<void(Lab&, int tick)>;  // before a tick

Run run(world::WorldModel model, int threads, int ticks, const Act& act) {
  for (auto& engine : model.engines) engine.threads = threads;
  Lab lab(std::move(model));
  Run run;
  for (int i = 0; i < ticks; ++i) {
    if (act) act(lab, i);
    const StepResult result = lab.step();
    EXPECT_TRUE(result.ok) << result.fault;
    run.hashes.push_back(lab.hash());
    run.work.push_back(result.work);
    run.warned += result.warned;
    run.limited += result.limited;
  }
  return run;
}

world::EngineSetting setting(std::uint64_t work_limit = 0) {
  world::EngineSetting setting = physics::engine_row("impulse").setting;
  setting.work_limit = work_limit;
  return setting;
}

// Returns the run with one thread.
Run expect_same(const world::WorldModel& model, int ticks, bool limited = false, const Act& act = {}) {
  const Run one = run(model, 1, ticks, act);
  EXPECT_EQ(one.limited > 0, limited);
  for (const int threads : {2, 4})
    EXPECT_TRUE(run(model, threads, ticks, act) == one) << threads << " threads";
  return one;
}

TEST(Threads, LeaveTheSameBitsInPiles) {
  expect_same(physics::piles(setting(), kTick, 4, 10), 400);
}

// An answer is dear by the work that it has taken.
TEST(Threads, LeaveTheSameBitsWhereAnswersAreInexact) {
  ModelBuilder b(setting(200'000));
  b.model = physics::piles(setting(200'000), kTick, 1, 60);
  for (int i = 0; i < 6; ++i)
    b.add_box("box_apart_" + std::to_string(i), {0.2, 0.2, 0.2}, 1.0, at(20.0 + i, 0, 0.2 + 0.05 * i));
  EXPECT_GT(expect_same(b.model, 1000).warned, 0);
}

TEST(Threads, LeaveTheSameBitsInTowers) {
  expect_same(physics::towers(setting(), kTick, 9, 5), 100);
}

TEST(Threads, LeaveTheSameBitsInQuadrupeds) {
  expect_same(physics::standing_quadrupeds(setting(), kTick, 4, physics::Held::kByFriction), 150);
  expect_same(physics::standing_quadrupeds(setting(), kTick, 4, physics::Held::kBySprings), 150);
}

// Steps that are cut in halves, and islands that are solved gently.
TEST(Threads, LeaveTheSameBitsInRagdolls) {
  expect_same(physics::falling_ragdolls(setting(), kTick, 3), 1000);
}

// A weight that whirls so fast that nearly every step is cut in halves, for all of the world.
TEST(Threads, LeaveTheSameBitsWhereOneIslandCutsTheSteps) {
  ModelBuilder b(setting());
  b.model = physics::piles(setting(), kTick, 3, 6);
  const world::BodyId weight = b.add_box("weight", {0.02, 0.02, 0.02}, 1.0, at(20.1, 0, 5));
  b.add_joint("hinge", world::JointKind::kHinge, {}, weight, {20, 0, 5}, Eigen::Vector3d::UnitY());
  b.body(weight).w_WB = {0, 900, 0};
  b.body(weight).v_WB = {0, 0, -90};
  EXPECT_GT(expect_same(b.model, 300).warned, 100);
}

// Boxes that bounce, chains with stops, friction, damping and drives, and balls in free flight.
world::WorldModel mixed_world(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  const world::SurfaceId bouncy = b.add_surface(0.4, 0.5);
  b.add_ground(bouncy);
  for (int k = 0; k < 4; ++k) {
    const std::string name = std::to_string(k);
    for (int i = 0; i < 3; ++i)
      b.add_box("box_" + name + std::to_string(i), {0.2, 0.15, 0.1}, 1.0,
                at(3.0 * k + 0.05 * i, 0.02 * i, 0.1 + 0.2 * i, 0.4 * i, {1, 2, 3}), bouncy);
    const world::BodyId upper =
        b.add_box("upper_" + name, {0.3, 0.05, 0.05}, 0.5, at(3.0 * k, 2, 0.4), bouncy);
    const world::BodyId lower =
        b.add_box("lower_" + name, {0.3, 0.05, 0.05}, 0.5, at(3.0 * k + 0.3, 2, 0.4), bouncy);
    world::Joint& joint = b.add_joint("hinge_" + name, world::JointKind::kHinge, upper, lower,
                                      {3.0 * k + 0.15, 2, 0.4}, Eigen::Vector3d::UnitY());
    joint.limited = true;
    joint.lower = -0.3;
    joint.upper = 0.2;
    joint.stop_restitution = 0.6;
    joint.friction = 0.05 * (k % 3);
    joint.damping = 0.01 * (k % 2);
    b.add_sphere("ball_" + name, 0.1, 1.0, at(3.0 * k, -2, 3));
  }
  return b.model;
}

// Wrenches on a free body, one that touches and one with joints, and a drive that meets its limit.
void act_on_mixed_world(Lab& lab, int tick) {
  lab.wrenches.clear();
  if (tick % 50 < 10)
    for (const char* name : {"box_01", "lower_2", "ball_2"})
      lab.wrenches.push_back({lab.model.find_body(name), {0, 5, 30}, {0.1, 0, 0.2}});
  lab.drive("hinge_1") = {.target_velocity = tick / 100 % 2 == 0 ? -1.0 : 1.0,
                          .compliance = 0.5,
                          .max_effort = 0.4,
                          .feedforward = 0.1};
}

TEST(Threads, LeaveTheSameBitsInAWorldOfAllSorts) {
  expect_same(mixed_world(setting()), 500, false, act_on_mixed_world);
  expect_same(mixed_world(setting(4'000)), 300, true, act_on_mixed_world);
  world::EngineSetting sleepy = setting(), fourth = setting(), poisson = setting();
  sleepy.sleep_s = 0.1;
  expect_same(mixed_world(sleepy), 2000, false, act_on_mixed_world);
  fourth.order = 4;
  expect_same(mixed_world(fourth), 300, false, act_on_mixed_world);
  poisson.impact = "poisson";
  expect_same(mixed_world(poisson), 300, false, act_on_mixed_world);
}

// A tick whose work meets its limit is made anew by one thread.
TEST(Threads, LeaveTheSameBitsWhereTheWorkIsLimited) {
  expect_same(physics::piles(setting(20'000), kTick, 4, 10), 400, true);
  expect_same(physics::falling_ragdolls(setting(60'000), kTick, 3), 1000, true);
}

}  // namespace
}  // namespace visum::dynamics::testing
