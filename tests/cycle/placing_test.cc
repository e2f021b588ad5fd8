// A world whose bodies and joints are put elsewhere while it runs, pulls, and what a reset takes back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/cycle/text_world.h"

namespace visum::cycle {
namespace {

using Eigen::Vector3d;
using protocol::ResetScope;
using ::testing::HasSubstr;

constexpr const char* kFallingBall =
    "{name: ball, mass: 0.5, pose: {xyz: [1, 0, 2]}, shapes: [{sphere: 0.1}]}";

scene::Scene model_scene(const std::string& name) {
  return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes" / name);
}

double joint_of(const Simulation& world, const std::string& joint) {
  return world.state().joints[world.model().find_joint(joint).index()].position;
}

world::JointPlacement placement(const Simulation& world, const std::string& joint, double position) {
  return {world.model().find_joint(joint), position, 0.0};
}

TEST(PlacedBodies, GoWhereTheyArePutAndFallFromThere) {
  Simulation world(scene_of(std::string("bodies: [") + kFallingBall + "]\n"));
  run(world, 100);
  const auto ball = world.model().find_body("ball");
  ASSERT_EQ(world.set_body(ball, world::Pose{{0, 0, 5}}, {1, 0, 0}, Vector3d::Zero()).text(), "");
  run(world, 1000);
  EXPECT_NEAR(state_of(world, "ball").p_WC.x(), 1.0, 1e-9);
  EXPECT_NEAR(state_of(world, "ball").p_WC.z(), 5.0 - 0.5 * 9.81, 1e-9);
}

TEST(PlacedBodies, BeyondAllBoundsAreRefusedAndNothingChanges) {
  Simulation world(scene_of(std::string("bodies: [") + kFallingBall +
                            ", {name: floor, fixed: true, shapes: [{plane: "
                            "true}]}]\n"));
  const auto before = world.state_hash();
  const auto ball = world.model().find_body("ball"), floor = world.model().find_body("floor");
  EXPECT_EQ(world.set_body(ball, world::Pose{{2e6, 0, 0}}, Vector3d::Zero(), Vector3d::Zero()).refusal(),
            Refusal::kBadValue);
  EXPECT_THAT(world.set_body(floor, {}, Vector3d::Zero(), Vector3d::Zero()).text(), HasSubstr("is fixed"));
  EXPECT_EQ(world.state_hash(), before);
}

// Its drives stand where they were put, until they get a new command.
TEST(PlacedJoints, StayWithTheirDrives) {
  Simulation world(model_scene("amtec_arm.yaml"));
  run(world, 200);
  const world::JointPlacement to[] = {placement(world, "arm/joint_1", 1.0),
                                      placement(world, "arm/joint_4", 0.9)};
  ASSERT_EQ(world.set_joints(to).text(), "");
  EXPECT_NEAR(joint_of(world, "arm/joint_1"), 1.0, 1e-12);
  run(world, 1500);
  EXPECT_NEAR(joint_of(world, "arm/joint_1"), 1.0, 2e-3);
  EXPECT_NEAR(joint_of(world, "arm/joint_4"), 0.9, 2e-3);
  EXPECT_EQ(world.parts()[0].part->trips(), 0u) << world.parts()[0].part->trip_text();
  world.write_inputs(0, 0, std::vector{0.5});  // Desired Angle 1
  run(world, 4000);
  EXPECT_NEAR(joint_of(world, "arm/joint_1"), 0.5, 2e-3) << "a new command moves it";
  EXPECT_NEAR(joint_of(world, "arm/joint_4"), 0.9, 2e-3);
}

TEST(PlacedJoints, TakeAlongThoseThatFollowThem) {
  Simulation world(model_scene("amtec_arm.yaml"));
  const auto before = world.state_hash();
  const world::JointPlacement twice[] = {placement(world, "arm/joint_1", 0.1),
                                         placement(world, "arm/joint_1", 0.2)};
  EXPECT_THAT(world.set_joints(twice).text(), HasSubstr("'arm/joint_1' is given twice"));
  const world::JointPlacement beyond[] = {placement(world, "arm/joint_1", 100.0)};
  EXPECT_EQ(world.set_joints(beyond).refusal(), Refusal::kBadValue);
  EXPECT_EQ(world.state_hash(), before);
}

class Pulled : public ::testing::TestWithParam<const char*> {};

// x(t) = x0 (1 + w t) exp(-w t) with w = 20 rad/s.
TEST_P(Pulled, AFreeBodyComesToTheTargetAsACriticallyDampedOscillator) {
  Simulation world(scene_of(std::string("gravity: [0, 0, 0]\nbodies: [") + kFallingBall + "]\n", GetParam()));
  ASSERT_EQ(world.pull({world.model().find_body("ball"), Vector3d::Zero(), {0, 0, 2}, 1e6}).text(), "");
  for (int i = 1; i <= 500; ++i) {
    world.tick();
    const double t = i * 1e-3, x = (1 + 20 * t) * std::exp(-20 * t);
    EXPECT_NEAR(state_of(world, "ball").p_WC.x(), x, 0.015) << "at " << t << " s";
    EXPECT_GE(state_of(world, "ball").p_WC.x(), -1e-6) << "it does not swing beyond";
  }
  EXPECT_NEAR(state_of(world, "ball").p_WC.x(), 0.0, 1e-3);
}

TEST_P(Pulled, WithNoMoreThanTheGreatestForce) {
  Simulation world(scene_of(std::string("gravity: [0, 0, 0]\nbodies: [") + kFallingBall + "]\n", GetParam()));
  ASSERT_TRUE(world.pull({world.model().find_body("ball"), Vector3d::Zero(), {1000, 0, 2}, 2.0}).done());
  run(world, 100);
  EXPECT_NEAR(state_of(world, "ball").v_WC.x(), 2.0 / 0.5 * 0.1, 1e-6);
}

TEST_P(Pulled, AThinRodByItsEndStaysSane) {
  Simulation world(scene_of(
      "bodies:\n"
      "- {name: rod, mass: 0.2, pose: {xyz: [0, 0, 0.5]}, shapes: [{cylinder: {radius: 0.005, length: 1}}]}\n"
      "- {name: floor, fixed: true, shapes: [{plane: true}]}\n",
      GetParam()));
  const auto rod = world.model().find_body("rod");
  for (int i = 0; i < 3000; ++i) {
    const Vector3d target(std::sin(0.01 * i), std::cos(0.013 * i), 0.6 + 0.5 * std::sin(0.007 * i));
    ASSERT_TRUE(world.pull({rod, {0, 0, 0.5}, target, 50.0}).done());
    world.tick();
    ASSERT_FALSE(world.frozen()) << world.fault();
    ASSERT_LT(state_of(world, "rod").v_WC.norm(), 30.0);
  }
}

TEST_P(Pulled, AnArmStaysSane) {
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml",
                                 {GetParam()});
  Simulation world(std::move(scene));
  const auto hand = world.model().joints[world.model().find_joint("arm/joint_7").index()].child;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d target(1.5 * std::sin(0.01 * i), 1.5 * std::cos(0.013 * i), 1.0);
    ASSERT_TRUE(world.pull({hand, {0, 0, 0.1}, target, 200.0}).done());
    world.tick();
    ASSERT_FALSE(world.frozen()) << world.fault();
    ASSERT_LT(world.state().bodies[hand.index()].v_WC.norm(), 10.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, Pulled, ::testing::Values("impulse", "ode"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Pulls, EndWithTheirTimeTheirOwnerAndARestore) {
  Simulation world(scene_of(std::string("gravity: [0, 0, 0]\nbodies: [") + kFallingBall + "]\n"));
  const auto ball = world.model().find_body("ball");
  const Pull pull{ball, Vector3d::Zero(), {0, 0, 2}, 1.0, 0, 7};
  const auto without = world.state_hash();
  ASSERT_TRUE(world.pull(pull).done());
  EXPECT_NE(world.state_hash(), without) << "a pull is part of the state";
  EXPECT_THAT(world.pull({ball, Vector3d::Zero(), {1, 0, 2}, 1.0, 0, 8}).text(),
              HasSubstr("pulled by another session"));
  world.release_all_of(8);
  EXPECT_EQ(world.pulls().size(), 1u);
  world.release_all_of(7);
  EXPECT_EQ(world.state_hash(), without);
  ASSERT_TRUE(world.pull({ball, Vector3d::Zero(), {0, 0, 2}, 1.0, 5, 7}).done());
  run(world, 6);
  EXPECT_TRUE(world.pulls().empty()) << "its time is over";
  ASSERT_TRUE(world.pull(pull).done());
  const auto snapshot = world.take_snapshot();
  ASSERT_TRUE(world.restore_snapshot(snapshot).done());
  EXPECT_TRUE(world.pulls().empty()) << "nobody holds it any more";
}

TEST(Pulls, ThatEndAtTheTickWhereTimeBeginsAnewAreOver) {
  Simulation world(scene_of(std::string("gravity: [0, 0, 0]\nbodies: [") + kFallingBall + "]\n"));
  const auto ball = world.model().find_body("ball");
  ASSERT_TRUE(world.pull({ball, Vector3d::Zero(), {0, 0, 2}, 1.0, 5, 7}).done());
  run(world, 5);
  world.reset(protocol::ResetScope::kTime);
  EXPECT_TRUE(world.pulls().empty());
}

class ResetOf : public ::testing::Test {
 protected:
  ResetOf() {
    run(world, 300);
    EXPECT_TRUE(world.add_body(kFallingBall).done());
    world.write_inputs(0, 0, std::vector{0.7});
    run(world, 200);
    EXPECT_EQ(world.tick_count(), 500);
  }
  bool has_ball() const { return world.model().find_body("ball").valid(); }
  Simulation world{model_scene("two_link.yaml")};
};

TEST_F(ResetOf, TimeAloneLeavesEverythingElse) {
  Simulation other(model_scene("two_link.yaml"));
  run(other, 300);
  ASSERT_TRUE(other.add_body(kFallingBall).done());
  other.write_inputs(0, 0, std::vector{0.7});
  run(other, 200);
  ASSERT_TRUE(world.push({{world.model().find_body("ball"), {1, 0, 0}, {0, 0, 0}}, 600}).done());
  ASSERT_TRUE(other.push({{other.model().find_body("ball"), {1, 0, 0}, {0, 0, 0}}, 600}).done());
  world.reset(ResetScope::kTime);
  EXPECT_EQ(world.tick_count(), 0);
  EXPECT_EQ(world.era(), other.era() + 1);
  run(world, 400);
  run(other, 400);
  EXPECT_EQ(world.tick_count(), 400);
  for (std::size_t i = 0; i < world.state().bodies.size(); ++i) {
    EXPECT_EQ(world.state().bodies[i].p_WC, other.state().bodies[i].p_WC)
        << "the push ends after as many ticks";
    EXPECT_EQ(world.state().bodies[i].v_WC, other.state().bodies[i].v_WC);
  }
}

TEST_F(ResetOf, StateAloneLetsTimeGoOn) {
  const auto era = world.era();
  world.reset(ResetScope::kState);
  EXPECT_EQ(world.tick_count(), 500);
  EXPECT_EQ(world.era(), era + 1);
  EXPECT_TRUE(has_ball());
  EXPECT_NEAR(state_of(world, "ball").p_WC.z(), 2.0, 1e-12);
  EXPECT_EQ(world.parts()[0].controller_inputs[0],
            world.parts()[0].part->description().controller_inputs[0].initial);
}

TEST_F(ResetOf, WhatWasSpawnedLeavesTheRest) {
  const auto link = state_of(world, "robot/fore");
  ASSERT_EQ(world.reset_now(ResetScope::kSpawned).text(), "");
  EXPECT_FALSE(has_ball());
  EXPECT_EQ(world.tick_count(), 500);
  EXPECT_EQ(state_of(world, "robot/fore").p_WC, link.p_WC);
  ASSERT_TRUE(world.remove_body("floor").done());
  ASSERT_TRUE(world.reset_now(ResetScope::kSpawned).done());
  EXPECT_TRUE(world.model().find_body("floor").valid()) << "what went is back";
  run(world, 100);
  EXPECT_FALSE(world.frozen());
}

TEST_F(ResetOf, AllIsTheSceneAsItWasLoaded) {
  ASSERT_TRUE(world.reset_now(ResetScope::kAll).done());
  EXPECT_EQ(world.state_hash(), Simulation(model_scene("two_link.yaml")).state_hash());
  Simulation fresh(model_scene("two_link.yaml"));
  run(world, 500);
  run(fresh, 500);
  EXPECT_EQ(world.state_hash(), fresh.state_hash());
}

TEST_F(ResetOf, SpawnedThingsKeepTheStateOfABodyOfTheSameNameApart) {
  ASSERT_TRUE(world.reset_now(ResetScope::kAll).done());
  ASSERT_TRUE(world.remove_body("floor").done());
  ASSERT_EQ(world.add_body("{name: floor, mass: 1, pose: {xyz: [9, 9, 9]}, shapes: [{sphere: 1}]}").text(),
            "");
  ASSERT_TRUE(world.reset_now(ResetScope::kSpawned).done());
  EXPECT_TRUE(state_of(world, "floor").p_WC.isZero(0.0)) << "not where its namesake was";
}

}  // namespace
}  // namespace visum::cycle
