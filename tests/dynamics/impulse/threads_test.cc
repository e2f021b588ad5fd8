// Islands on several threads: any number of them gives the same bits.
#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <thread>

#include "server/dynamics/impulse/island_pool.h"
#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/legged_models.h"

namespace visum::dynamics::testing {
namespace {

constexpr double kTick = 1e-3;

TEST(IslandPool, DoesEachThingOnce) {
  for (const int threads : {1, 2, 4}) {
    impulse::IslandPool pool(threads);
    EXPECT_EQ(pool.threads(), static_cast<std::size_t>(threads));
    // Many rounds of all sizes, so that a thread that wakes late would be seen.
    std::vector<int> done(64, 0), by_worker(4, 0);
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

TEST(IslandPool, BeginsWithSharesOfTheSameCost) {
  impulse::IslandPool pool(2);
  // One dear thing, and nine cheap ones. Each thread waits in its first until the other has begun, too.
  std::vector<int> first(2, -1);
  std::atomic<int> begun = 0;
  auto work = [&](std::size_t worker, std::size_t i) {
    if (first[worker] >= 0) return;
    first[worker] = static_cast<int>(i);
    ++begun;
    while (begun < 2) std::this_thread::yield();
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
    while (i == 0 && done < 9) std::this_thread::yield();
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

Run run(world::WorldModel model, int threads, int ticks) {
  for (auto& engine : model.engines) engine.threads = threads;
  Lab lab(std::move(model));
  Run run;
  for (int i = 0; i < ticks; ++i) {
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

void expect_same(const world::WorldModel& model, int ticks, bool limited = false) {
  const Run one = run(model, 1, ticks);
  EXPECT_EQ(one.limited > 0, limited);
  for (const int threads : {2, 4}) EXPECT_TRUE(run(model, threads, ticks) == one) << threads << " threads";
}

TEST(Threads, LeaveTheSameBitsInPiles) {
  expect_same(physics::piles(setting(), kTick, 4, 10), 400);
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

// A tick whose work meets its limit is made anew by one thread.
TEST(Threads, LeaveTheSameBitsWhereTheWorkIsLimited) {
  expect_same(physics::piles(setting(40'000), kTick, 4, 10), 400, true);
  expect_same(physics::falling_ragdolls(setting(100'000), kTick, 3), 1000, true);
}

}  // namespace
}  // namespace visum::dynamics::testing
