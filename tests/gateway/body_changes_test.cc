// AddBody and RemoveBody on the tick's side: made ready on a thread of its own, in the order in which they
// came.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <semaphore>
#include <string>
#include <utility>
#include <vector>

#include "server/gateway/tick_side.h"
#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using protocol::AddBody;
using protocol::ErrorCode;
using protocol::Ok;
using protocol::RemoveBody;
using ::testing::HasSubstr;

std::string ball(const std::string& name) {
  return "{name: " + name + ", mass: 0.1, pose: {xyz: [1.5, 1.5, 0.5]}, shapes: [{sphere: 0.05}]}";
}

// The tick's side alone, turned by hand. The world's clock is the parameter.
class Changes : public ::testing::TestWithParam<scene::ClockKind> {
 protected:
  Changes() {
    tick_side.on_change_ready([this] { ready.release(); });
  }
  ~Changes() override { tick_side.end_changes(); }
  void send(protocol::Request request) {
    ASSERT_TRUE(
        mailbox.send(std::make_unique<Command>(Command{1, ++last_id, 0, 0, std::move(request), {}, {}})));
  }
  // Waits for the change that is made ready, and takes it.
  void take_next() {
    ASSERT_TRUE(ready.try_acquire_for(std::chrono::seconds(60)));
    tick_side.empty_mailbox();
  }
  // The replies that came back, with the numbers of their requests.
  std::vector<std::pair<std::uint64_t, protocol::Reply>> replies() {
    tick_side.give_back();
    std::vector<std::pair<std::uint64_t, protocol::Reply>> all;
    while (auto command = mailbox.next_done()) all.emplace_back(command->id, std::move(command->reply));
    return all;
  }
  bool has(const std::string& body) const { return simulation.model().find_body(body).valid(); }

  static scene::Scene scene_of(scene::ClockKind clock) {
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
    scene.clock = clock;
    return scene;
  }
  cycle::Simulation simulation{scene_of(GetParam())};
  Mailbox mailbox{64};
  std::counting_semaphore<> ready{0};
  TickSide tick_side{simulation, mailbox, true};
  std::uint64_t last_id = 0;
};

TEST_P(Changes, ComeInTheirOrder) {
  send(AddBody{ball("a")});
  send(RemoveBody{"a"});
  send(AddBody{ball("a")});
  tick_side.empty_mailbox();
  EXPECT_TRUE(replies().empty());
  for (std::uint64_t id = 1; id <= 3; ++id) {
    take_next();
    const auto came = replies();
    ASSERT_EQ(came.size(), 1u);
    EXPECT_EQ(came[0].first, id);
    EXPECT_TRUE(std::holds_alternative<Ok>(came[0].second)) << id;
    EXPECT_EQ(has("a"), id != 2);
  }
}

TEST_P(Changes, ABadBodyIsRefusedAndTheNextOneIsBegun) {
  const auto before = simulation.state_hash();
  send(AddBody{"{name: egg, mass: -1, shapes: [{sphere: 0.05}]}"});
  send(AddBody{ball("b")});
  tick_side.empty_mailbox();
  take_next();
  const auto came = replies();
  ASSERT_EQ(came.size(), 1u);
  EXPECT_THAT(std::get<protocol::Error>(came[0].second).text, HasSubstr("mass: must be greater than 0"));
  EXPECT_EQ(simulation.state_hash(), before);
  take_next();
  EXPECT_TRUE(has("b"));
}

TEST_P(Changes, AreEndedInTheMiddleOfOne) {
  for (int i = 0; i < 4; ++i) send(AddBody{ball("b" + std::to_string(i))});
  tick_side.empty_mailbox();
}

INSTANTIATE_TEST_SUITE_P(All, Changes,
                         ::testing::Values(scene::ClockKind::kRealtime, scene::ClockKind::kLockstep,
                                           scene::ClockKind::kFree),
                         [](const auto& info) { return std::string(scene::name_of(info.param)); });

class ChangesInRealTime : public Changes {};

TEST_P(ChangesInRealTime, DoNotHoldUpTheTicks) {
  send(AddBody{ball("a")});
  tick_side.empty_mailbox();
  EXPECT_FALSE(tick_side.waits_for_change());
  for (int i = 0; i < 20; ++i) tick_side.tick();  // none of them takes the change
  EXPECT_EQ(simulation.tick_count(), 20);
  EXPECT_FALSE(has("a"));
  take_next();
  EXPECT_TRUE(has("a"));
}

TEST_P(ChangesInRealTime, OtherCommandsAreAnsweredMeanwhile) {
  send(AddBody{ball("a")});
  send(protocol::Pause{});
  tick_side.empty_mailbox();
  const auto came = replies();
  ASSERT_EQ(came.size(), 1u);
  EXPECT_EQ(came[0].first, 2u);
}

TEST_P(ChangesInRealTime, TooManyAtOnceAreRefused) {
  for (std::size_t i = 0; i <= BodyChanges::kMost; ++i) send(AddBody{ball("b" + std::to_string(i))});
  tick_side.empty_mailbox();
  const auto came = replies();
  ASSERT_EQ(came.size(), 1u);
  EXPECT_EQ(came[0].first, BodyChanges::kMost + 1);
  EXPECT_EQ(std::get<protocol::Error>(came[0].second).code, ErrorCode::kBusy);
  for (std::size_t i = 0; i < BodyChanges::kMost; ++i) take_next();
  EXPECT_EQ(replies().size(), BodyChanges::kMost);
}

INSTANTIATE_TEST_SUITE_P(All, ChangesInRealTime, ::testing::Values(scene::ClockKind::kRealtime),
                         [](const auto& info) { return std::string(scene::name_of(info.param)); });

class ChangesInLockstep : public Changes {};

TEST_P(ChangesInLockstep, HoldTheWorldAndAllThatCameLater) {
  send(AddBody{ball("a")});
  send(protocol::TakeSnapshot{});
  for (std::size_t i = 0; i <= BodyChanges::kMost; ++i) send(AddBody{ball("b" + std::to_string(i))});
  tick_side.empty_mailbox();
  EXPECT_TRUE(tick_side.waits_for_change());
  EXPECT_TRUE(replies().empty()) << "how long a change takes decides nothing";
  take_next();
  auto came = replies();
  ASSERT_EQ(came.size(), 2u) << "the change and the snapshot behind it";
  EXPECT_TRUE(std::holds_alternative<protocol::SnapshotTaken>(came[1].second));
  for (std::size_t i = 0; i <= BodyChanges::kMost; ++i) {
    EXPECT_TRUE(tick_side.waits_for_change());
    take_next();
    EXPECT_TRUE(has("b" + std::to_string(i))) << "they come one by one, so that none is refused as too many";
  }
  EXPECT_FALSE(tick_side.waits_for_change());
}

INSTANTIATE_TEST_SUITE_P(All, ChangesInLockstep,
                         ::testing::Values(scene::ClockKind::kLockstep, scene::ClockKind::kFree),
                         [](const auto& info) { return std::string(scene::name_of(info.param)); });

// About the longest text that is read: it takes about a second.
std::string long_body(bool good) {
  std::string yaml = "{name: long, mass: 1, pose: {xyz: [50, 50, 50]}, shapes: [";
  for (int i = 0; i < (good ? 1000 : 4000); ++i) yaml += "{box: [0.1, 0.2, 0.3], color: [1, 1, 1, 1]},\n";
  return yaml + "]}";
}

TEST(AddBodyInTheDaemon, IsAnsweredWhileTicksAndOtherSessionsGoOn) {
  DaemonOptions options;
  options.run_at_once = true;
  RunningDaemon daemon(scene::ClockKind::kRealtime, options);
  auto admin = daemon.connect("admin", protocol::Role::kAdmin);
  auto other = daemon.connect("other");
  const auto tick = [&] { return other.request_as<protocol::ServerStatus>(protocol::Status{}).tick; };
  const auto bad = refusal_of([&] { admin.request(AddBody{long_body(false)}); });
  EXPECT_EQ(bad.code(), ErrorCode::kBadValue);
  EXPECT_THAT(bad.what(), HasSubstr("more than 1000 shapes"));
  const auto before = tick();
  admin.request(AddBody{long_body(true)});
  EXPECT_GT(tick(), before);
  EXPECT_EQ(admin.request_as<protocol::WorldDescription>(protocol::DescribeWorld{}).bodies.back().name,
            "long");
  admin.request(RemoveBody{"long"});
}

TEST(AddBodyInTheDaemon, OfTooLongATextIsRefusedAndTheSessionStays) {
  for (const auto clock : {scene::ClockKind::kRealtime, scene::ClockKind::kLockstep}) {
    RunningDaemon daemon(clock);
    auto admin = daemon.connect("admin", protocol::Role::kAdmin);
    const auto before = state_hash(admin);
    const auto refused =
        refusal_of([&] { admin.request(AddBody{"{name: [" + std::string(9'000'000, 'x')}); });
    EXPECT_EQ(refused.code(), ErrorCode::kBadValue);
    EXPECT_STREQ(refused.what(), "the body has 9000008 bytes, an added body has at most 1048576");
    EXPECT_EQ(state_hash(admin), before);
  }
}

TEST(AddBodyInTheDaemon, InLockstepActsAtTheTickAtWhichItWasAsked) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto admin = daemon.connect("admin", protocol::Role::kAdmin);
  admin.request(protocol::Join{});
  advance(admin, 50);
  admin.request(AddBody{long_body(true)});
  EXPECT_EQ(admin.request_as<protocol::ServerStatus>(protocol::Status{}).tick, 50);
  advance(admin, 10);
  admin.request(RemoveBody{"long"});
  EXPECT_EQ(admin.request_as<protocol::ServerStatus>(protocol::Status{}).tick, 60);
}

}  // namespace
}  // namespace visum::gateway
