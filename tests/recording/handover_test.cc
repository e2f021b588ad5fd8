// Bytes from one thread to another: all of them, in their order, and never more than may wait.
#include "server/recording/handover.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <thread>

namespace visum::recording {
namespace {

std::span<const std::byte> raw(const std::uint64_t& number) {
  return std::as_bytes(std::span(&number, 1));
}

TEST(Handover, TakesWhatWasPutOnce) {
  Handover handover(64);
  EXPECT_TRUE(handover.take().empty());
  for (const std::uint64_t number : {1u, 2u, 3u}) ASSERT_TRUE(handover.put(raw(number), {}));
  const auto taken = handover.take();
  ASSERT_EQ(taken.size(), 24u);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(std::memcmp(&taken[8 * i], raw(i + 1).data(), 8), 0);
  EXPECT_TRUE(handover.take().empty());
}

TEST(Handover, PutsAllOfAMessageOrNothing) {
  Handover handover(16);
  const std::uint64_t head = 1, body = 2;
  ASSERT_TRUE(handover.put(raw(head), {}));
  EXPECT_EQ(handover.room(), 8u);
  EXPECT_FALSE(handover.put(raw(head), raw(body))) << "16 bytes, and there is room for 8";
  EXPECT_TRUE(handover.put({}, raw(body)));
  EXPECT_EQ(handover.room(), 0u);
  EXPECT_EQ(handover.take().size(), 16u);
  EXPECT_TRUE(handover.put(raw(head), raw(body))) << "what was taken makes room";
}

// Each number in turn, from one thread to another that takes all the time.
TEST(Handover, LosesNothingBetweenTwoThreads) {
  constexpr std::uint64_t kNumbers = 200'000;
  Handover handover(800);
  std::thread putter([&] {
    for (std::uint64_t i = 0; i < kNumbers; ++i)
      while (!handover.put(raw(i), {})) std::this_thread::yield();
  });
  std::uint64_t expected = 0, most = 0;
  while (expected < kNumbers) {
    const auto taken = handover.take();
    if (taken.empty()) std::this_thread::yield();
    most = std::max<std::uint64_t>(most, taken.size());
    for (std::size_t at = 0; at < taken.size(); at += 8) {
      std::uint64_t number = 0;
      std::memcpy(&number, &taken[at], sizeof number);
      if (number != expected) {
        ADD_FAILURE() << number << " instead of " << expected;
        at = taken.size();
      }
      expected = number + 1;
    }
  }
  putter.join();
  EXPECT_LE(most, 800u);
}

}  // namespace
}  // namespace visum::recording
