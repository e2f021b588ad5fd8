#include "server/world/on_processors.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace visum::world::testing {
namespace {

bool has_one_processor() {
  cpu_set_t set;
  return ::sched_getaffinity(0, sizeof set, &set) != 0 || CPU_COUNT(&set) < 2;
}

TEST(OnProcessors, EachPieceIsDoneOnceAndAllAreDoneInTheEnd) {
  for (const std::size_t count : {0, 1, 3, 1000}) {
    std::vector<int> done(count, 0);
    on_processors(count, 4, [&](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(count, 1));
  }
}

TEST(OnProcessors, NoMoreThreadsThanWanted) {
  for (const std::size_t most : {1, 2}) {
    std::mutex mutex;
    std::set<std::thread::id> threads;
    on_processors(100, most, [&](std::size_t) {
      const std::lock_guard lock(mutex);
      threads.insert(std::this_thread::get_id());
    });
    EXPECT_LE(threads.size(), most);
  }
}

TEST(OnProcessors, TwoPiecesAreDoneAtTheSameTime) {
  if (has_one_processor()) GTEST_SKIP() << "only one processor may be used";
  std::mutex mutex;
  std::condition_variable arrival;
  int here = 0, met = 0;
  on_processors(2, 2, [&](std::size_t) {
    std::unique_lock lock(mutex);
    ++here;
    arrival.notify_all();
    if (arrival.wait_for(lock, std::chrono::seconds(30), [&] { return here == 2; })) ++met;
  });
  EXPECT_EQ(met, 2);
}

TEST(OnProcessors, AnExceptionComesToTheCallerAndEndsTheWork) {
  constexpr std::size_t kCount = 100'000;
  for (const std::size_t most : {1, 4}) {
    std::atomic<std::size_t> begun = 0;
    std::string said;
    try {
      on_processors(kCount, most, [&](std::size_t i) {
        ++begun;
        if (i >= 10) throw std::runtime_error("this piece is bad");
      });
    } catch (const std::runtime_error& error) {
      said = error.what();
    }
    EXPECT_EQ(said, "this piece is bad");
    EXPECT_GE(begun, 11u);
    EXPECT_LE(begun, 10u + most);
  }
}

// The caller waits in its own piece, so that another thread throws.
TEST(OnProcessors, AnExceptionOfAnotherThreadComesToTheCaller) {
  if (has_one_processor()) GTEST_SKIP() << "only one processor may be used";
  const auto caller = std::this_thread::get_id();
  std::mutex mutex;
  std::condition_variable change;
  bool thrown = false;
  const auto act = [&](std::size_t i) {
    std::unique_lock lock(mutex);
    if (std::this_thread::get_id() != caller) {
      thrown = true;
      change.notify_all();
      throw std::out_of_range(std::to_string(i));
    }
    change.wait_for(lock, std::chrono::seconds(30), [&] { return thrown; });
  };
  EXPECT_THROW(on_processors(2, 2, act), std::out_of_range);
}

}  // namespace
}  // namespace visum::world::testing
