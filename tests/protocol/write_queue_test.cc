#include "protocol/write_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/codec.h"

namespace visum::protocol {
namespace {

constexpr std::size_t kMax = 1u << 20;

PartSample at_tick(std::int64_t tick) {
  return {"arm", tick, 0, 1, {}, {}, 0};
}

// Everything that the queue would write now, as texts like "sample 3" and "ok 7".
std::vector<std::string> drain(WriteQueue& queue) {
  std::vector<std::string> texts;
  while (!queue.empty()) {
    auto bytes = queue.front();
    const std::size_t batch = bytes.size();
    while (!bytes.empty()) {
      const auto length = frame_length(bytes.first<kHeaderBytes>());
      std::string why;
      const auto frame = decode_reply(bytes.subspan(kHeaderBytes, length), why);
      if (const auto* sample = std::get_if<PartSample>(&frame->reply))
        texts.push_back("sample " + std::to_string(sample->tick));
      else if (const auto* error = std::get_if<Error>(&frame->reply))
        texts.push_back("error " + std::to_string(frame->reply_to) + " " + to_string(error->code));
      else
        texts.push_back("ok " + std::to_string(frame->reply_to));
      bytes = bytes.subspan(kHeaderBytes + length);
    }
    queue.written(batch);
  }
  return texts;
}

using ::testing::ElementsAre;

TEST(WriteQueue, KeepsTheOrderOfReplies) {
  WriteQueue queue;
  for (int id = 1; id <= 3; ++id) queue.push(id, Ok{}, kMax);
  EXPECT_THAT(drain(queue), ElementsAre("ok 1", "ok 2", "ok 3"));
}

TEST(WriteQueue, KeepsOnlyTheNewestSampleOfAStream) {
  WriteQueue queue;
  EXPECT_TRUE(queue.push_latest(5, at_tick(1), kMax));
  EXPECT_FALSE(queue.push_latest(5, at_tick(2), kMax));
  EXPECT_TRUE(queue.push_latest(6, at_tick(3), kMax));
  EXPECT_THAT(drain(queue), ElementsAre("sample 2", "sample 3"));
}

TEST(WriteQueue, KnowsTheBytesThatAreNotWrittenYet) {
  WriteQueue queue;
  EXPECT_EQ(queue.bytes(), 0u);
  queue.push(1, Ok{}, kMax);
  queue.push_latest(5, at_tick(1), kMax);
  queue.push_latest(5, at_tick(2), kMax);
  const std::size_t all = queue.bytes();
  ASSERT_EQ(queue.front().size(), all);
  queue.written(3);
  queue.push(2, Ok{}, kMax);
  const std::size_t left = queue.front().size();
  EXPECT_EQ(left, all - 3);
  EXPECT_GT(queue.bytes(), left);
  queue.written(left);
  EXPECT_EQ(queue.front().size(), queue.bytes());
  queue.written(queue.bytes());
  EXPECT_EQ(queue.bytes(), 0u);
}

TEST(WriteQueue, PutsSamplesBeforeTheRepliesOfTheSameBatch) {
  WriteQueue queue;
  queue.push(1, Ok{}, kMax);
  queue.push_latest(5, at_tick(9), kMax);
  EXPECT_THAT(drain(queue), ElementsAre("sample 9", "ok 1"));
}

TEST(WriteQueue, NeverTearsABatchThatIsBeingWritten) {
  WriteQueue queue;
  queue.push(1, Ok{}, kMax);
  const std::size_t batch = queue.front().size();
  queue.written(3);
  queue.push_latest(5, at_tick(1), kMax);
  queue.push_latest(5, at_tick(2), kMax);
  queue.push(2, Ok{}, kMax);
  EXPECT_EQ(queue.front().size(), batch - 3);
  queue.written(batch - 3);
  EXPECT_THAT(drain(queue), ElementsAre("sample 2", "ok 2"));
}

TEST(WriteQueue, TellsWhetherASampleWaits) {
  WriteQueue queue;
  EXPECT_FALSE(queue.has_waiting(5));
  queue.push_latest(5, at_tick(1), kMax);
  EXPECT_TRUE(queue.has_waiting(5));
  queue.front();
  EXPECT_FALSE(queue.has_waiting(5));
}

TEST(WriteQueue, CountsOnlyWhatWaitsBehindTheBatchInFlight) {
  WriteQueue queue;
  queue.push(1, Ok{}, kMax);
  EXPECT_EQ(queue.waiting_replies(), 1u);
  queue.front();
  EXPECT_EQ(queue.waiting_replies(), 0u);
  EXPECT_EQ(queue.waiting_bytes(), 0u);
  queue.push(2, Ok{}, kMax);
  EXPECT_EQ(queue.waiting_replies(), 1u);
}

TEST(WriteQueue, SendsAnErrorInPlaceOfAReplyOverTheLimit) {
  WriteQueue queue;
  queue.push(4, BlackboardData{0, 1000, std::vector<std::byte>(1000), 1}, 100);
  EXPECT_THAT(drain(queue), ElementsAre("error 4 too large"));
}

}  // namespace
}  // namespace visum::protocol
