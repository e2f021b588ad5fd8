// The rules of a session without a socket, and with a time that the test advances.
#include <gtest/gtest.h>

#include <random>

#include "tests/protocol/fixture.h"
#include "tests/protocol/memory_session.h"
#include "tests/protocol/vectors.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;
using testing::frame_of;
using testing::MemorySession;

class SessionRules : public ::testing::Test {
 protected:
  void greet() { session.feed(frame_of(1, Hello{1, 1, "tester", Role::kController, ""})); }
  void pass(milliseconds time) {
    context.now += time;
    session.sweep();
  }

  Limits limits;
  testing::NotingHandler handler;
  SessionContext context{limits, handler};
  MemorySession session{context};
};

TEST_F(SessionRules, HelloMustBeWholeWithinItsDeadline) {
  const auto hello = frame_of(1, Hello{1, 1, "tester", Role::kController, ""});
  session.feed(std::span(hello).first(5));
  pass(limits.hello_deadline / 4);
  EXPECT_FALSE(session.closing());
  session.feed(std::span(hello).subspan(5, 1));
  pass(limits.hello_deadline);
  EXPECT_TRUE(session.closing());
  EXPECT_EQ(session.close_reason(), CloseReason::kRefused);
  EXPECT_TRUE(handler.closed.empty());
}

TEST_F(SessionRules, TheFramesClockStartsWithItsFirstByteAndEndsWithItsLast) {
  greet();
  const auto frame = frame_of(2, Status{});
  for (int i = 0; i < 10; ++i) {
    session.feed(std::span(frame).first(2));
    pass(limits.frame_deadline * 9 / 10);
    session.feed(std::span(frame).subspan(2));
    pass(limits.frame_deadline * 9 / 10);
    ASSERT_FALSE(session.closing());
  }
  session.feed(std::span(frame).first(2));
  pass(limits.frame_deadline / 2);
  session.feed(std::span(frame).subspan(2, 1));
  pass(limits.frame_deadline / 2 + milliseconds(1));
  EXPECT_TRUE(session.closing());
}

TEST_F(SessionRules, NothingIsHandledAfterAClose) {
  greet();
  auto frames = frame_of(2, Status{});
  handler.answer = [](Session& s, std::uint64_t, const Request&) { s.close(CloseReason::kRefused); };
  const auto second = frame_of(3, Status{});
  frames.insert(frames.end(), second.begin(), second.end());
  session.feed(frames);
  EXPECT_EQ(handler.asked.size(), 1u);
  EXPECT_EQ(handler.closed.size(), 1u);
}

TEST_F(SessionRules, ACloseIsToldOnce) {
  greet();
  session.end();
  session.close(CloseReason::kLost);
  session.end();
  ASSERT_EQ(handler.closed.size(), 1u);
  EXPECT_EQ(handler.closed[0].reason, CloseReason::kGoodbye);
}

TEST_F(SessionRules, AnyBytesEndInAnAnswerOrAClose) {
  std::mt19937_64 random(3);
  const auto vectors = testing::make_vectors();
  for (int round = 0; round < 20'000; ++round) {
    SessionContext fresh{limits, handler};
    MemorySession victim(fresh);
    victim.feed(frame_of(1, Hello{1, 1, "fuzz", Role::kAdmin, ""}));
    for (int step = 0; step < 5 && !victim.closing(); ++step) {
      auto bytes = vectors[random() % vectors.size()].frame;
      if (random() % 2) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
      bytes.resize(random() % 4 ? bytes.size() : random() % bytes.size());
      victim.feed(bytes);
    }
    victim.end();
    ASSERT_TRUE(victim.closing());
  }
  EXPECT_TRUE(handler.sessions.empty());
}

}  // namespace
}  // namespace visum::protocol
