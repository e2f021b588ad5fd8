#include "server/world/on_processors.h"

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace visum::world::testing {
namespace {

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

}  // namespace
}  // namespace visum::world::testing
