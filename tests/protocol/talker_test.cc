// The session whose client speaks most: who it is, and that nobody is overheard.
#include "protocol/talker.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/protocol/fixture.h"

namespace visum::protocol {
namespace {

using namespace std::chrono_literals;
using testing::RawClient;

class FakeSession : public Speaker {
 public:
  explicit FakeSession(Talker& talker) : talker_(talker) {}
  bool is_looked_after() const override { return looked_after_; }
  bool take_now() override {
    if (!has_spoken) return false;
    hear();
    return true;
  }
  void wait_for_bytes() override { looked_after_ = false; }
  // Reads all that was there.
  void hear() {
    has_spoken = false;
    looked_after_ = false;
    looked_after_ = talker_.takes(*this);
  }

  bool has_spoken = false;

 private:
  Talker& talker_;
  bool looked_after_ = false;
};

class TalkerTest : public ::testing::Test {
 protected:
  Talker talker;
  FakeSession first{talker}, second{talker};
};

TEST_F(TalkerTest, IsWhoSpokeFirst) {
  EXPECT_FALSE(talker.look()) << "nobody has spoken";
  EXPECT_FALSE(talker.goes_first());
  first.hear();
  EXPECT_TRUE(first.is_looked_after());
  EXPECT_FALSE(talker.look());
  first.has_spoken = true;
  EXPECT_TRUE(talker.look());
  EXPECT_TRUE(first.is_looked_after()) << "again";
}

TEST_F(TalkerTest, IsAnotherOnceThatOneHasSpokenTwiceInARow) {
  first.hear();
  second.hear();
  EXPECT_FALSE(second.is_looked_after());
  first.hear();
  second.hear();
  EXPECT_TRUE(first.is_looked_after()) << "they take turns";
  second.hear();
  EXPECT_TRUE(second.is_looked_after());
  EXPECT_FALSE(first.is_looked_after()) << "it waits by itself";
}

TEST_F(TalkerTest, LeavesTheOthersOneLookOfSome) {
  first.hear();
  unsigned for_others = 0;
  for (unsigned look = 0; look < 10 * Talker::kLooks; ++look) for_others += !talker.goes_first();
  EXPECT_EQ(for_others, 10u);
}

TEST_F(TalkerTest, WaitsByItselfWhereNobodyLooks) {
  first.hear();
  talker.rest();
  EXPECT_FALSE(first.is_looked_after());
  EXPECT_FALSE(talker.look());
  second.hear();
  EXPECT_TRUE(second.is_looked_after()) << "the place is free";
}

TEST_F(TalkerTest, ForgetsWhoEnds) {
  {
    FakeSession ended(talker), rival(talker);
    ended.hear();
    rival.hear();
    talker.forget(ended);
    talker.forget(rival);
  }
  EXPECT_FALSE(talker.look());
  second.hear();
  EXPECT_TRUE(second.is_looked_after());
}

class ServerWithTalker : public testing::ServerTest {
 protected:
  // Says something, and is answered.
  void speak(RawClient& client) {
    client.send(++id_, Status{});
    EXPECT_EQ(next(client).reply_to, id_);
  }
  RawClient client{port()};
  std::uint64_t id_ = 0;
};

TEST_F(ServerWithTalker, HearsItWhereTheLoopOnlyPolls) {
  greet(client);
  speak(client);
  client.send(++id_, Status{});
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (handler.asked.size() < 2 && std::chrono::steady_clock::now() < end) server().poll();
  EXPECT_EQ(handler.asked.size(), 2u);
}

TEST_F(ServerWithTalker, IsWokenByItAfterItFellAsleep) {
  greet(client);
  for (int round = 0; round < 3; ++round) {
    speak(client);
    const std::size_t asked = handler.asked.size() + 1;
    std::thread later([this, frame = testing::frame_of(++id_, Status{})] {
      std::this_thread::sleep_for(50ms);  // longer than the server looks busily
      client.send(frame);
    });
    const auto begin = std::chrono::steady_clock::now();
    while (handler.asked.size() < asked) server().poll_for(20s);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
    later.join();
    EXPECT_EQ(next(client).reply_to, id_);
  }
}

TEST_F(ServerWithTalker, HearsOthersWhileItTalks) {
  greet(client);
  RawClient other(port());
  greet(other);
  for (int round = 0; round < 20; ++round) {
    for (int time = 0; time < round % 4; ++time) speak(client);
    speak(other);
  }
}

TEST_F(ServerWithTalker, SeesThatItHasGone) {
  for (const bool resets : {false, true}) {
    RawClient goes(port());
    greet(goes);
    speak(goes);
    const std::size_t closed = handler.closed.size();
    resets ? goes.reset() : goes.finish_sending();
    EXPECT_TRUE(until([&] { return handler.closed.size() > closed; })) << resets;
  }
}

TEST_F(ServerWithTalker, HearsItInALoopOfItsOwn) {
  greet(client);
  speak(client);
  std::thread asks([&] {
    client.send(++id_, Status{});
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (!client.reply() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(1ms);
    server().stop();
  });
  server().run();
  asks.join();
  EXPECT_EQ(handler.asked.size(), 2u);
}

}  // namespace
}  // namespace visum::protocol
