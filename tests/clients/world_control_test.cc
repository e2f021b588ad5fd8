// WorldControl of the C++ client library in front of a real daemon.
#include "clients/cpp/world.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "tests/clients/daemon_thread.h"

namespace visum {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;

class WorldOfAClient : public ::testing::Test {
 protected:
  // Where a body stands, by the base of a chain or by the protocol's own client.
  std::vector<double> pose_of(const std::string& body) {
    protocol::Connection link("127.0.0.1", daemon_.port(), {1, 1, "looks", protocol::Role::kObserver, {}});
    const auto world = link.request_as<protocol::WorldDescription>(protocol::DescribeWorld{});
    const auto now = link.request_as<protocol::WorldSample>(protocol::ReadWorld{});
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
      if (world.bodies[i].name == body)
        return {now.poses.begin() + static_cast<std::ptrdiff_t>(7 * i),
                now.poses.begin() + static_cast<std::ptrdiff_t>(7 * i + 7)};
    return {};
  }
  ErrorCode refusal(const std::function<void()>& call) {
    try {
      call();
    } catch (const Error& error) {
      text_ = error.what();
      return error.code();
    }
    return ErrorCode::kUnspecified;
  }

  DaemonThread daemon_{scene::ClockKind::kLockstep, 1.0};
  Client client_{daemon_.address(), {.name = "bench", .role = Role::kAdmin}};
  WorldControl world_{client_};
  std::string text_;  // of the last refusal
};

TEST_F(WorldOfAClient, HoldsAndMovesTime) {
  client_.join();
  client_.advance_ms(20);
  const auto era = client_.era();
  world_.reset(ResetScope::kState);
  client_.advance_ms(1);
  EXPECT_EQ(client_.tick(), 21);
  EXPECT_GT(client_.era(), era);
  const auto snapshot = world_.take_snapshot();
  client_.advance_ms(10);
  world_.restore_snapshot(snapshot);
  client_.advance_ms(1);
  EXPECT_EQ(client_.tick(), 22);
  EXPECT_EQ(refusal([&] { world_.restore_snapshot(99); }), ErrorCode::kUnknownName);
  EXPECT_EQ(refusal([&] { world_.set_speed(2.0); }), ErrorCode::kWrongState) << "the clock is lockstep";
}

TEST_F(WorldOfAClient, PutsPushesAndPullsBodies) {
  world_.add_body("{name: ball, mass: 0.5, pose: {xyz: [1.5, 0, 2]}, shapes: [{sphere: 0.1}]}");
  client_.join();
  world_.set_body("ball", Pose{{2, 1, 3}}, {{0, 0, 1}});
  EXPECT_EQ(pose_of("ball"), (std::vector<double>{2, 1, 3, 1, 0, 0, 0}));
  client_.advance_ms(10);
  EXPECT_GT(pose_of("ball")[2], 3.0);
  world_.pull_body("ball", {2, 1, 4}, 50.0);
  client_.advance_ms(800);
  EXPECT_NEAR(pose_of("ball")[2], 4.0 - 9.81 / 400, 0.01);
  world_.push_body("ball", {5, 0, 0}, 0.2);
  client_.advance_ms(100);
  EXPECT_GT(pose_of("ball")[0], 2.0);
  client_.advance_ms(150);  // until the push is over
  world_.release_body("ball");
  EXPECT_EQ(refusal([&] { world_.release_body("ball"); }), ErrorCode::kWrongState);
  world_.set_joints("arm", {{"joint_1", 0.5}});
  EXPECT_EQ(refusal([&] { world_.set_joints("arm", {{"joint_1", 99.0}}); }), ErrorCode::kBadValue);
  EXPECT_EQ(refusal([&] { world_.set_joints("arm", {}, {{"joint_1", 1.0}}); }), ErrorCode::kMisuse);
  world_.remove_body("ball");
  EXPECT_TRUE(pose_of("ball").empty());
}

TEST_F(WorldOfAClient, BringsModelsWithTheirParts) {
  const std::filesystem::path cart(VISUM_SOURCE_DIR "/models/cart/cart.yaml");
  client_.join();
  const auto spawned = world_.spawn_file(cart, {.name = "second", .pose = {{0, 4, 0}}});
  EXPECT_EQ(spawned.name, "second");
  EXPECT_THAT(spawned.parts, ElementsAre("second"));
  EXPECT_THAT(client_.part_names(), Contains("second"));
  {
    Part part = client_.part("second");
    part.acquire();
    part.all_inputs().set(0, 1.0);
    part.write();
    client_.advance_ms(20);
    part.release();
  }
  EXPECT_EQ(refusal([&] { world_.spawn_file(cart, {.name = "second"}); }), ErrorCode::kBadValue);
  EXPECT_EQ(world_.spawn_file(cart, {.name = "second", .pose = {{0, 6, 0}}, .unique = true}).name,
            "second_2");
  EXPECT_THAT(world_.spawned_models(), ElementsAre("second", "second_2"));
  world_.remove_model("second");
  EXPECT_EQ(refusal([&] { client_.part("second"); }), ErrorCode::kUnknownName);
  EXPECT_EQ(refusal([&] { world_.spawn("none.yaml"); }), ErrorCode::kUnknownName);
  EXPECT_EQ(refusal([&] { world_.spawn_file("/nowhere/arm.urdf"); }), ErrorCode::kMisuse);
  EXPECT_THAT(text_, HasSubstr("/nowhere/arm.urdf"));
  world_.reset(ResetScope::kSpawned);
  EXPECT_THAT(world_.spawned_models(), ElementsAre());
}

TEST_F(WorldOfAClient, LoadsAnotherScene) {
  EXPECT_THAT(world_.scenes(), Contains("cart"));
  EXPECT_THAT(world_.scenarios(), Contains("pick_and_place"));
  client_.join();
  client_.advance_ms(20);
  const auto era = client_.era();
  world_.load_scene("cart");
  client_.advance_ms(10);
  EXPECT_EQ(client_.tick(), 10);
  EXPECT_EQ(client_.era(), era + 1);
  EXPECT_THAT(client_.part_names(), ElementsAre("cart"));
  Part cart = client_.part("cart");
  cart.acquire();
  world_.load_scene("amtec_arm");
  EXPECT_EQ(refusal([&] { cart.read(); }), ErrorCode::kUnknownName);
  EXPECT_EQ(refusal([&] { world_.load_scene("../cart"); }), ErrorCode::kUnknownName);
}

TEST_F(WorldOfAClient, HearsOfEvents) {
  Client other(daemon_.address(), {.name = "gripper"});
  EXPECT_EQ(world_.subscribe_events(EventLevel::kWarning).size(), 0u);
  WorldControl of_other(other);
  of_other.announce("the box is gripped", true, EventLevel::kError);
  of_other.announce("not worth a warning");
  world_.pause();
  const auto events = world_.events();
  ASSERT_THAT(events, Contains(Field(&EventInfo::kind, "check")));
  const auto check = std::ranges::find(events, "check", &EventInfo::kind);
  EXPECT_EQ(check->text, "the box is gripped");
  EXPECT_EQ(check->source, "gripper");
  EXPECT_EQ(check->level, EventLevel::kError);
  EXPECT_EQ(std::ranges::count(events, "line", &EventInfo::kind), 0);
  world_.unsubscribe_events();
  EXPECT_EQ(refusal([&] { world_.unsubscribe_events(); }), ErrorCode::kWrongState);
  world_.resume();
  EXPECT_EQ(refusal([&] { WorldControl(other).pause(); }), ErrorCode::kForbidden);
}

}  // namespace
}  // namespace visum
