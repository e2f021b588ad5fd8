#include "protocol/frame_buffer.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/protocol/raw_client.h"

namespace visum::protocol {
namespace {

using State = FrameBuffer::State;
using Bytes = std::vector<std::byte>;

Bytes frame_with(std::size_t length, int fill) {
  Bytes frame = testing::header_of(static_cast<std::uint32_t>(length));
  frame.resize(frame.size() + length, static_cast<std::byte>(fill));
  return frame;
}

// Puts in as much as fits at once, and returns how much that was.
std::size_t put(FrameBuffer& buffer, std::span<const std::byte> bytes) {
  const auto space = buffer.space();
  const std::size_t count = std::min(space.size(), bytes.size());
  std::memcpy(space.data(), bytes.data(), count);
  buffer.commit(count);
  return count;
}

TEST(FrameBuffer, IsEmptyAtFirst) {
  FrameBuffer buffer(64, 64);
  EXPECT_EQ(buffer.next(100).state, State::kEmpty);
}

TEST(FrameBuffer, GivesAFrameWhenItsLastByteIsThere) {
  FrameBuffer buffer(64, 64);
  const Bytes frame = frame_with(3, 7);
  for (const std::byte& byte : frame) {
    EXPECT_NE(buffer.next(100).state, State::kFrame);
    put(buffer, {&byte, 1});
  }
  const auto next = buffer.next(100);
  ASSERT_EQ(next.state, State::kFrame);
  EXPECT_EQ(Bytes(next.payload.begin(), next.payload.end()), Bytes(3, std::byte{7}));
  EXPECT_EQ(buffer.next(100).state, State::kEmpty);
}

TEST(FrameBuffer, RefusesALengthOverTheLimitByItsHeaderAlone) {
  FrameBuffer buffer(64, 64);
  put(buffer, testing::header_of(101));
  const auto next = buffer.next(100);
  EXPECT_EQ(next.state, State::kTooLarge);
  EXPECT_EQ(next.length, 101u);
}

TEST(FrameBuffer, TakesAFrameOfExactlyTheLimit) {
  FrameBuffer buffer(64, 64);
  Bytes frame = frame_with(100, 1);
  std::span<const std::byte> left(frame);
  while (!left.empty()) {
    buffer.next(100);
    left = left.subspan(put(buffer, left));
  }
  EXPECT_EQ(buffer.next(100).state, State::kFrame);
}

TEST(FrameBuffer, GrowsByWhatCameNotByWhatIsAnnounced) {
  FrameBuffer buffer(64, 64);
  put(buffer, testing::header_of(16u << 20));
  EXPECT_EQ(buffer.next(16u << 20).state, State::kPartial);
  EXPECT_LE(buffer.space().size(), 128u);
}

TEST(FrameBuffer, GivesMemoryBackWhenItIsEmpty) {
  FrameBuffer buffer(64, 128);
  const Bytes frame = frame_with(100'000, 1);
  std::span<const std::byte> left(frame);
  while (!left.empty()) {
    buffer.next(1u << 20);
    left = left.subspan(put(buffer, left));
  }
  ASSERT_EQ(buffer.next(1u << 20).state, State::kFrame);
  EXPECT_EQ(buffer.space().size(), 128u);
}

TEST(FrameBuffer, FindsTheSameFramesHoweverTheBytesAreCut) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    Bytes stream;
    std::vector<std::size_t> sent, received;
    for (int i = 0; i < 20; ++i) {
      sent.push_back(random() % 300);
      const Bytes frame = frame_with(sent.back(), i);
      stream.insert(stream.end(), frame.begin(), frame.end());
    }
    FrameBuffer buffer(16, 64);
    std::span<const std::byte> left(stream);
    while (!left.empty()) {
      left = left.subspan(put(buffer, left.first(std::min<std::size_t>(left.size(), 1 + random() % 100))));
      for (auto next = buffer.next(300); next.state == State::kFrame; next = buffer.next(300)) {
        for (const std::byte byte : next.payload) ASSERT_EQ(byte, static_cast<std::byte>(received.size()));
        received.push_back(next.payload.size());
      }
    }
    ASSERT_EQ(received, sent);
  }
}

}  // namespace
}  // namespace visum::protocol
