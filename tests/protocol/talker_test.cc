// The session whose client speaks most: who it is, and that nobody is overheard.
#include "protocol/talker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
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
  EXPECT_FALSE(talker.takes_turn());
  first.hear();
  EXPECT_TRUE(first.is_looked_after());
  EXPECT_FALSE(talker.look());
  first.has_spoken = true;
  EXPECT_TRUE(talker.look());
  EXPECT_TRUE(first.is_looked_after()) << "again";
}

TEST_F(TalkerTest, IsAnotherOnceOthersHaveSpokenTwiceWithoutAWordFromIt) {
  first.hear();
  for (int time = 0; time < 3; ++time) {
    second.hear();
    EXPECT_FALSE(second.is_looked_after());
    first.hear();
    EXPECT_TRUE(first.is_looked_after()) << "they take turns";
  }
  FakeSession third{talker};
  second.hear();
  third.hear();
  EXPECT_TRUE(third.is_looked_after());
  EXPECT_FALSE(first.is_looked_after()) << "it waits by itself";
  talker.forget(third);
}

TEST_F(TalkerTest, LeavesTheOthersOneTurnOfSome) {
  first.hear();
  unsigned for_all = 0;
  for (unsigned turn = 0; turn < 10 * Talker::kTurns; ++turn) for_all += !talker.takes_turn();
  EXPECT_EQ(for_all, 10u);
}

TEST_F(TalkerTest, WaitsByItselfOnceItIsSilentForLong) {
  first.hear();
  for (int look = 1; look < Talker::kMostInVain; ++look) EXPECT_FALSE(talker.look());
  EXPECT_TRUE(first.is_looked_after());
  EXPECT_FALSE(talker.look());
  EXPECT_FALSE(first.is_looked_after());
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

// The bytes end the very wait in which they come. Nothing else would: deadlines are looked at every 50 ms,
// and only the wait after that would find them.
TEST_F(ServerWithTalker, IsWokenByItAfterItFellAsleep) {
  constexpr int kRounds = 12;
  greet(client);
  int woken = 0;
  for (int round = 0; round < kRounds; ++round) {
    speak(client);
    const std::size_t asked = handler.asked.size() + 1;
    std::atomic<bool> sent{false};
    std::thread later([&, frame = testing::frame_of(++id_, Status{})] {
      std::this_thread::sleep_for(20ms + 7ms * round);  // longer than the server looks busily
      sent = true;
      client.send(frame);
    });
    const auto end = std::chrono::steady_clock::now() + 10s;
    bool slept_before = false;
    while (handler.asked.size() < asked && std::chrono::steady_clock::now() < end) {
      slept_before = !sent;
      server().poll_for(1s);
    }
    woken += slept_before;
    later.join();
    EXPECT_EQ(next(client).reply_to, id_);
  }
  EXPECT_GE(woken, kRounds - 2) << "but where it was sent between two waits";
}

TEST_F(ServerWithTalker, HearsOthersWhileItTalksWithoutAPause) {
  greet(client);
  RawClient other(port());
  greet(other);
  for (int round = 0; round < 20; ++round) {
    other.send(++id_, Status{});
    const auto is_answered = [&] {
      return std::ranges::any_of(handler.asked, [&](const auto& asked) { return asked.id == id_; });
    };
    unsigned waits = 0;
    for (; !is_answered() && waits < 100; ++waits) {
      client.send(1'000'000 + waits, Status{});  // there before the server looks
      server().poll_for(1ms);
    }
    EXPECT_LE(waits, 4 * Talker::kTurns);
    EXPECT_EQ(next(other).reply_to, id_);
    while (client.reply()) {
    }
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
