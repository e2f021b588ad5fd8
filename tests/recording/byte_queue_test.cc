// Bytes from one thread to another: all of them, in their order, and never more than may wait.
#include "server/recording/byte_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <thread>
#include <vector>

namespace visum::recording {
namespace {

constexpr std::size_t kBlock = ByteQueue::kBlockBytes;

// Numbers that go on from one call to the next.
class Numbers {
 public:
  std::vector<std::byte> next(std::size_t size) {
    std::vector<std::byte> bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::byte>(next_++ * 2654435761u >> 24);
    return bytes;
  }

 private:
  std::uint32_t next_ = 0;
};

bool put(ByteQueue& queue, std::span<const std::byte> first, std::span<const std::byte> second = {}) {
  const std::array pieces{first, second};
  return queue.put(pieces);
}

std::vector<std::byte> take(ByteQueue& queue, std::size_t size) {
  std::vector<std::byte> bytes(size);
  queue.take(bytes);
  return bytes;
}

TEST(ByteQueue, GivesThePiecesInTheirOrder) {
  ByteQueue queue(3 * kBlock);
  Numbers in, out;
  for (int i = 0; i < 200; ++i) {
    const auto head = in.next(24), body = in.next(static_cast<std::size_t>(i) * 997 % 50000);
    ASSERT_TRUE(put(queue, head, body));
    EXPECT_EQ(queue.waiting(), head.size() + body.size());
    EXPECT_EQ(take(queue, head.size()), out.next(head.size()));
    EXPECT_EQ(take(queue, body.size()), out.next(body.size()));
    EXPECT_EQ(queue.waiting(), 0u);
    EXPECT_EQ(queue.room(), 3 * kBlock);
  }
}

TEST(ByteQueue, TakesAllThatMayWaitAndNotAByteMore) {
  for (const std::size_t capacity : {std::size_t{10}, kBlock, 3 * kBlock, 3 * kBlock + 7}) {
    ByteQueue queue(capacity);
    Numbers in, out;
    const std::byte one{};
    for (const std::size_t taken : {std::size_t{1}, capacity / 2, capacity - 1, capacity, std::size_t{3}}) {
      ASSERT_TRUE(put(queue, in.next(queue.room()))) << capacity;
      EXPECT_EQ(queue.room(), 0u);
      EXPECT_FALSE(put(queue, {}, std::span(&one, 1)));
      EXPECT_EQ(queue.waiting(), capacity);
      ASSERT_EQ(take(queue, taken), out.next(taken)) << capacity << " " << taken;
      EXPECT_EQ(queue.room(), taken);
    }
  }
}

// One thread puts pieces of many lengths, and the queue is often full.
TEST(ByteQueue, LosesNothingBetweenTwoThreads) {
  constexpr std::size_t kAll = 40u << 20;
  ByteQueue queue(5 * kBlock);
  std::thread putter([&] {
    Numbers in;
    for (std::size_t done = 0, size = 1; done < kAll; done += size, size = (size * 31 + 7) % 20011) {
      size = std::min(size, kAll - done);
      const auto bytes = in.next(size);
      while (!put(queue, std::span(bytes).first(size / 2), std::span(bytes).subspan(size / 2)))
        std::this_thread::yield();
    }
  });
  Numbers out;
  bool same = true;
  for (std::size_t done = 0; done < kAll;) {
    const auto size = std::min<std::size_t>(queue.waiting(), 30011);
    if (size == 0) std::this_thread::yield();
    same = take(queue, size) == out.next(size) && same;
    done += size;
  }
  putter.join();
  EXPECT_TRUE(same);
  EXPECT_EQ(queue.waiting(), 0u);
}

}  // namespace
}  // namespace visum::recording
