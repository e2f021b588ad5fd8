// The world's truth, for observers; pushing, adding and removing bodies, for the role admin.
#include <gtest/gtest.h>

#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;

std::size_t body_index(const WorldDescription& world, const std::string& name) {
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    if (world.bodies[i].name == name) return i;
  ADD_FAILURE() << "no body " << name;
  return 0;
}

TEST(Truth, DescribesBodiesShapesAndJoints) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("observer", Role::kObserver);
  const auto world = client.request_as<WorldDescription>(DescribeWorld{});
  EXPECT_EQ(world.scene, "amtec_arm");
  EXPECT_EQ(world.tick_ns, 1'000'000);
  EXPECT_FALSE(world.bodies[body_index(world, "box")].shapes.empty());
  int driven = 0;
  for (const auto& joint : world.joints) driven += joint.part == "arm";
  EXPECT_EQ(driven, 9) << "seven hinges and two sliders, as in the paper";
}

TEST(Truth, TellsWhereSensorsSitAndWhatTheyLookAt) {
  RunningDaemon daemon("sensors.yaml", scene::ClockKind::kLockstep);
  auto client = daemon.connect("observer", Role::kObserver);
  const auto world = client.request_as<WorldDescription>(DescribeWorld{});
  ASSERT_EQ(world.sensors.size(), 7u);
  const auto &eye = world.sensors[0], &scan = world.sensors[1], &camera = world.sensors[5];
  EXPECT_EQ(eye.part + " " + eye.kind + " " + eye.body, "eye distance table");
  EXPECT_EQ(eye.pose, (std::vector<double>{0, 0, 0.1, 1, 0, 0, 0}));
  EXPECT_EQ(eye.range, (std::vector<double>{0.05, 6}));
  EXPECT_TRUE(eye.angle.empty());
  EXPECT_TRUE(scan.body.empty()) << "it stands in the world";
  EXPECT_EQ(scan.angle, (std::vector<double>{-3.14159, 3.14159}));
  EXPECT_EQ(camera.kind, "camera");
  EXPECT_EQ(camera.range, (std::vector<double>{0, 100}));
  EXPECT_NEAR(camera.fov, 75 * M_PI / 180, 1e-12);
  EXPECT_DOUBLE_EQ(camera.aspect, 640.0 / 480.0);
}

TEST(Truth, ABlackboardsGenerationChangesWithItsContentAndOnlyThen) {
  RunningDaemon daemon("sensors.yaml", scene::ClockKind::kLockstep);
  auto client = daemon.connect("observer");
  client.request(Join{});
  const auto scan = [&] {
    return client.request_as<BlackboardData>(ReadBlackboard{"scan", "scan"}).generation;
  };
  advance(client, 150);  // it scans each 100 ms
  const auto first = scan();
  EXPECT_EQ(scan(), first);
  advance(client, 40);
  EXPECT_EQ(scan(), first) << "the same scan still";
  advance(client, 20);
  EXPECT_NE(scan(), first);
}

TEST(Truth, KeepsThePeakForceBetweenTwoLooks) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("admin", Role::kAdmin);
  client.request(Join{});
  const auto world = client.request_as<WorldDescription>(DescribeWorld{});
  const auto box = body_index(world, "box");
  const double weight = world.bodies[box].mass_kg * 9.81;
  advance(client, 500);
  client.request_as<WorldSample>(ReadWorld{});
  client.request(PushBody{"box", {0, 0, -50.0}, {}, {}, 20'000'000});
  advance(client, 500);
  const auto sample = client.request_as<WorldSample>(ReadWorld{});
  EXPECT_GT(sample.peak_contact_forces.at(box), weight + 25.0) << "long over, still seen";
  advance(client, 100);
  EXPECT_NEAR(client.request_as<WorldSample>(ReadWorld{}).peak_contact_forces.at(box), weight, 0.2 * weight);
}

TEST(Truth, BodiesComeAndGo) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("admin", Role::kAdmin);
  client.request(Join{});
  client.request(AddBody{"{name: ball, mass: 0.1, pose: {xyz: [1.5, 1.5, 0.5]}, shapes: [{sphere: 0.05}]}"});
  auto world = client.request_as<WorldDescription>(DescribeWorld{});
  const auto ball = body_index(world, "ball");
  advance(client, 2000);
  EXPECT_NEAR(client.request_as<WorldSample>(ReadWorld{}).poses.at(7 * ball + 2), 0.05, 2e-3)
      << "it lies on the floor";
  client.request(RemoveBody{"ball"});
  world = client.request_as<WorldDescription>(DescribeWorld{});
  for (const auto& body : world.bodies) EXPECT_NE(body.name, "ball");
  EXPECT_EQ(refusal_of([&] { client.request(RemoveBody{"ball"}); }).code(), ErrorCode::kUnknownName);
  EXPECT_EQ(refusal_of([&] { client.request(RemoveBody{"arm/link_3"}); }).code(), ErrorCode::kWrongState);
  const auto wrong =
      refusal_of([&] { client.request(AddBody{"{name: egg, mass: -1, shapes: [{sphere: 0.05}]}"}); });
  EXPECT_EQ(wrong.code(), ErrorCode::kBadValue);
  EXPECT_NE(std::string(wrong.what()).find("mass"), std::string::npos) << wrong.what();
}

TEST(Truth, AFrozenWorldSaysSoAndResetRevivesIt) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  auto client = daemon.connect("admin", Role::kAdmin);
  client.request(Join{});
  // The largest push that is accepted, on a grain, makes it faster than anything sane.
  client.request(AddBody{"{name: grain, mass: 1.0e-5, pose: {xyz: [2, 2, 1]}, shapes: [{sphere: 0.01}]}"});
  client.request(PushBody{"grain", {1e6, 0, 0}, {}, {}, 1'000'000'000});
  const auto error = refusal_of([&] { advance(client, 1000); });
  EXPECT_EQ(error.code(), ErrorCode::kFrozen);
  EXPECT_NE(std::string(error.what()).find("grain"), std::string::npos) << error.what();
  EXPECT_TRUE(client.request_as<ServerStatus>(Status{}).frozen);
  client.request(Reset{});
  EXPECT_EQ(advance(client, 10).tick, 10);
}

}  // namespace
}  // namespace visum::gateway
