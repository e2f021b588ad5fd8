// Replies that wait for those that follow: how long, and what makes them leave.
#include <gtest/gtest.h>

#include <initializer_list>
#include <vector>

#include "protocol/codec.h"
#include "tests/protocol/fixture.h"

namespace visum::protocol {
namespace {

using testing::RawClient;

class Holding : public testing::ServerTest {};

struct Patient : Holding {
  Patient() { options.limits.longest_hold_back = std::chrono::hours(1); }
};

// A client whose answers are held back.
class HoldingBack : public Patient {
 protected:
  HoldingBack() {
    handler.answer = [](Session& to, std::uint64_t id, const Request&) {
      to.send(id, Ok{});
      to.hold_back(true);
    };
  }
  // In one packet: the kernel would send a second one only once the first is acknowledged.
  void ask(std::initializer_list<std::uint64_t> ids) {
    std::vector<std::byte> stream;
    for (const auto id : ids) encode_request(id, Status{}, stream);
    client.send(stream);
    const std::size_t before = handler.asked.size();
    while (handler.asked.size() < before + ids.size()) server().poll();
  }
  RawClient client{port()};
  Session& session{greet(client)};
};

TEST_F(HoldingBack, WhatIsHeldBackLeavesWithWhatFollowsIt) {
  ask({1, 2});
  server().write();
  EXPECT_FALSE(client.reply());
  session.hold_back(false);
  session.send(3, Ok{});
  server().write();
  for (const std::uint64_t id : {1u, 2u, 3u}) {
    const auto frame = client.reply();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->reply_to, id);
  }
}

TEST_F(HoldingBack, ItLeavesOnceTheServerHasNothingToDo) {
  ask({1});
  server().poll_for(std::chrono::seconds(10));
  EXPECT_TRUE(client.reply()) << "a millisecond later";
  ask({2});
  server().poll_for(std::chrono::nanoseconds(0));
  EXPECT_TRUE(client.reply()) << "it may not wait";
}

TEST_F(Holding, WhatIsHeldBackLeavesAfterAMomentThoughTheServerIsBusy) {
  RawClient client(port());
  auto& session = greet(client);
  session.send(1, Ok{});
  session.hold_back(true);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  bool came = false;
  while (!came && std::chrono::steady_clock::now() < deadline) {
    server().write();
    came = client.reply().has_value();
  }
  EXPECT_TRUE(came);
}

TEST_F(HoldingBack, ItLeavesWhenTheSessionCloses) {
  ask({1});
  session.close(CloseReason::kGoodbye);
  server().write();
  EXPECT_TRUE(client.reply());
}

TEST_F(HoldingBack, SamplesAndEventsTakeItWithThem) {
  ask({1});
  session.send_latest(1, PartSample{"arm", 1, 0, 1, {}, {}, 0});
  server().write();
  EXPECT_TRUE(client.reply());
  EXPECT_TRUE(client.reply()) << "one of both is the sample";
  ask({2});
  session.send(0, Event{"line", "text", {}, 0, 0});
  server().write();
  EXPECT_TRUE(client.reply());
}

TEST_F(HoldingBack, WhatIsTooMuchToWaitLeaves) {
  handler.answer = [](Session& to, std::uint64_t id, const Request&) {
    to.hold_back(true);
    while (!to.behind()) to.send(id, Error{ErrorCode::kBusy, std::string(1000, 'x'), {}});
  };
  ask({1});
  server().write();
  EXPECT_TRUE(client.reply());
}

}  // namespace
}  // namespace visum::protocol
