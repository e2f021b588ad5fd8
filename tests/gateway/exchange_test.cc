#include "server/world/exchange.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace visum::gateway {
namespace {

TEST(Exchange, GivesTheNewestAndOnlyOnce) {
  world::Exchange<int> exchange;
  EXPECT_FALSE(exchange.refresh());
  exchange.back() = 1;
  exchange.publish();
  exchange.back() = 2;
  exchange.publish();
  EXPECT_TRUE(exchange.refresh());
  EXPECT_EQ(exchange.front(), 2);
  EXPECT_FALSE(exchange.refresh());
  EXPECT_EQ(exchange.front(), 2);
}

TEST(Exchange, NeverTearsAValueBetweenThreads) {
  world::Exchange<std::vector<int>> exchange;
  constexpr int kLast = 200'000;
  std::thread writer([&] {
    for (int i = 1; i <= kLast; ++i) {
      exchange.back().assign(16, i);
      exchange.publish();
    }
  });
  int seen = 0;
  while (seen < kLast) {
    if (!exchange.refresh()) continue;
    const auto& value = exchange.front();
    ASSERT_EQ(value.size(), 16u);
    for (int number : value) ASSERT_EQ(number, value[0]);
    ASSERT_GT(value[0], seen) << "never an older one";
    seen = value[0];
  }
  writer.join();
}

}  // namespace
}  // namespace visum::gateway
