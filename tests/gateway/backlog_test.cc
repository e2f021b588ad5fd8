// Requests behind one that waits: as many, and of as many bytes, as the server keeps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "tests/gateway/gateway_rig.h"
#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using scene::ClockKind;
using ::testing::HasSubstr;

// The refusal of the request `id`; an empty text: it was not refused.
Error refusal_told_to(const NotedSession& session, std::uint64_t id) {
  const auto reply = std::ranges::find(session.replies, id, [](const auto& each) { return each.first; });
  if (reply == session.replies.end()) return {};
  const auto* error = std::get_if<Error>(&reply->second);
  return error ? *error : Error{};
}

class FullBacklog : public ::testing::Test {
 protected:
  FullBacklog() { rig.ask(admin, GetParameters{"arm"}); }  // waits for the tick's side
  std::uint64_t ask(std::size_t bytes) {
    admin.next_request_bytes = bytes;
    return rig.ask(admin, Read{"arm"});
  }
  void go_on() {
    rig.tick_side.empty_mailbox();
    rig.tell();
  }
  GatewayRig rig{ClockKind::kLockstep};
  NotedSession& admin{rig.connect("admin", Role::kAdmin)};
};

TEST_F(FullBacklog, OfManyBytesRefusesMoreAndNamesTheBound) {
  const std::size_t most = Limits{}.max_frame_admin;
  for (int i = 0; i < 2; ++i) EXPECT_EQ(refusal_told_to(admin, ask(most)).text, "");
  const auto refusal = refusal_told_to(admin, ask(most));
  EXPECT_EQ(refusal.code, ErrorCode::kBusy);
  EXPECT_EQ(refusal.text,
            "a request of 16777216 bytes has no room behind one that waits: at most 32 MiB wait "
            "there, and 33554432 bytes do already");
  EXPECT_THAT(refusal_told_to(admin, ask(1)).text, HasSubstr("a request of 1 bytes"));
}

TEST_F(FullBacklog, HasRoomAgainOnceItIsWorkedOff) {
  for (int round = 0; round < 3; ++round) {
    std::vector<std::uint64_t> ids;
    for (int i = 0; i < 2; ++i) ids.push_back(ask(16u << 20));
    go_on();
    for (const auto id : ids)
      EXPECT_TRUE(std::ranges::any_of(admin.replies, [&](const auto& each) {
        return each.first == id && std::holds_alternative<PartSample>(each.second);
      })) << round;
    rig.ask(admin, GetParameters{"arm"});
  }
}

TEST_F(FullBacklog, OfManyRequestsRefusesMoreAndNamesTheBound) {
  for (std::size_t i = 0; i < Backlog::kMost; ++i) EXPECT_EQ(refusal_told_to(admin, ask(10)).text, "");
  const auto refusal = refusal_told_to(admin, ask(10));
  EXPECT_EQ(refusal.code, ErrorCode::kBusy);
  EXPECT_EQ(refusal.text, "too many requests behind one that waits: at most 64 wait there");
}

// Over a socket, so that the bytes are those of the frames. The waiter holds the world.
TEST(FullBacklogOfADaemon, CountsTheBytesOfFrames) {
  RunningDaemon daemon(ClockKind::kLockstep);
  auto waiter = daemon.connect("waiter");
  auto admin = daemon.connect("admin", Role::kAdmin);
  const Join patiently{std::chrono::nanoseconds(std::chrono::hours(1)).count()};
  waiter.request(patiently);
  admin.request(patiently);
  const auto advance = admin.send(Advance{1});
  const AddBody large{std::string(15u << 20, '#')};
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < 3; ++i) ids.push_back(admin.send(large));
  const auto refusal = refusal_of([&] { admin.wait(ids.back()); });
  EXPECT_EQ(refusal.code(), ErrorCode::kBusy);
  EXPECT_THAT(refusal.what(), HasSubstr("at most 32 MiB wait there"));
  waiter.request(Leave{});
  EXPECT_TRUE(std::holds_alternative<Advanced>(admin.wait(advance)));
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(refusal_of([&] { admin.wait(ids[i]); }).code(), ErrorCode::kBadValue) << "too long a body";
}

}  // namespace
}  // namespace visum::gateway
