// Kinematic bodies: they move as they are told, push others by their motion, and nothing pushes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/cycle/text_world.h"

namespace visum::cycle {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kTick_s = 1e-3;

class Kinematic : public ::testing::TestWithParam<const char*> {
 protected:
  static double force_on(const Simulation& world, const std::string& body) {
    double force = 0.0;
    const auto id = world.model().find_body(body);
    for (const auto& contact : world.contacts())
      if (contact.body_a == id || contact.body_b == id) force += contact.normal_force_n;
    return force;
  }
};

TEST_P(Kinematic, MovesExactlyAsItsVelocitySays) {
  Simulation world(scene_of(
      "bodies: [{name: rod, kinematic: true, pose: {xyz: [0, 0, 1]}, velocity: {linear: [1, 0, 0], angular: "
      "[0, 0, 2]}, shapes: [{box: [1, 0.1, 0.1]}]}]\n",
      GetParam()));
  run(world, 1000);
  const auto& rod = state_of(world, "rod");
  EXPECT_NEAR((rod.p_WC - Vector3d(1, 0, 1)).norm(), 0.0, 1e-12) << "no gravity pulls it";
  EXPECT_NEAR(rod.q_WB.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Vector3d::UnitZ()))), 0.0,
              1e-9);
}

TEST_P(Kinematic, IsNotPushed) {
  Simulation world(scene_of(
      "bodies:\n"
      "- {name: plate, kinematic: true, pose: {xyz: [0, 0, 1]}, shapes: [{box: [1, 1, 0.1]}]}\n"
      "- {name: ball, mass: 100, pose: {xyz: [0, 0, 1.3]}, velocity: {linear: [0, 0, -3]}, shapes: [{sphere: "
      "0.2}]}\n",
      GetParam()));
  run(world, 1500);
  const auto& plate = state_of(world, "plate");
  EXPECT_EQ(plate.p_WC, Vector3d(0, 0, 1));
  EXPECT_TRUE(plate.v_WC.isZero(0.0));
  EXPECT_NEAR(state_of(world, "ball").p_WC.z(), 1.25, 2e-3);
  EXPECT_NEAR(force_on(world, "ball"), 981.0, 10.0);
}

// A box on a belt: friction takes it along, with mu g until it has the belt's speed.
TEST_P(Kinematic, ItsVelocityCountsInFriction) {
  Simulation world(
      scene_of("surfaces: {rubber: {friction: 0.5}}\n"
               "bodies:\n"
               "- {name: belt, kinematic: true, surface: rubber, velocity: {linear: [1, 0, 0]}, shapes: "
               "[{box: [40, 1, "
               "0.1]}]}\n"
               "- {name: box, mass: 2, surface: rubber, pose: {xyz: [0, 0, 0.15]}, shapes: [{box: [0.4, 0.4, "
               "0.2]}]}\n",
               GetParam()));
  run(world, 100);
  EXPECT_NEAR(state_of(world, "box").v_WC.x(), 0.5 * 9.81 * 0.1, 0.02);
  run(world, 400);
  EXPECT_NEAR(state_of(world, "box").v_WC.x(), 1.0, 1e-3);
}

// A plate under a cart gets faster: the force is mass times acceleration.
TEST_P(Kinematic, AWallThatGetsFasterPushesWithMassTimesAcceleration) {
  Simulation world(
      scene_of("surfaces: {ice: {friction: 0}}\n"
               "gravity: [0, 0, 0]\n"
               "bodies:\n"
               "- {name: wall, kinematic: true, surface: ice, pose: {xyz: [-0.2, 0, 0]}, shapes: [{box: "
               "[0.2, 1, 1]}]}\n"
               "- {name: cart, mass: 4, surface: ice, shapes: [{box: [0.2, 0.2, 0.2]}]}\n",
               GetParam()));
  const auto wall = world.model().find_body("wall");
  constexpr double kAcceleration = 1.5;
  double mean = 0.0;
  for (int i = 0; i < 600; ++i) {
    ASSERT_TRUE(world.set_body(wall, {}, {kAcceleration * i * kTick_s, 0, 0}, Vector3d::Zero()).done());
    world.tick();
    if (i >= 400) mean += force_on(world, "cart") / 200.0;
  }
  EXPECT_NEAR(mean, 4 * kAcceleration, 0.02 * 4 * kAcceleration);
}

// A door about z at the origin pushes a cart on a rail along y at x = L. The cart's buffer is a ball of
// radius b; with half the door's thickness d that makes r = b + d between the door's middle and the ball's:
//   y = L tan a + r / cos a, and with a = w t:
//   v = w (L / cos² a + r sin a / cos² a)
//   acc = w² (2 L sin a / cos³ a + r (1 + sin² a) / cos³ a)
// The rail is smooth, so the cart's buffer feels N = (m acc + c v) / cos a, with c the rail's damping.
TEST_P(Kinematic, ADoorPushesACartWithTheForceOfTheClosedForm) {
  constexpr double L = 0.6, b = 0.05, d = 0.02, r = b + d, m = 3.0, c = 8.0, w = 0.8;
  Simulation world(scene_of(
      "surfaces: {ice: {friction: 0}}\n"
      "gravity: [0, 0, 0]\n"
      "bodies:\n"
      "- {name: frame, fixed: true}\n"
      "- {name: door, kinematic: true, surface: ice, pose: {xyz: [0, 0, 0]}, shapes: [{box: [2.4, 0.04, "
      "1]}]}\n"
      "- {name: cart, mass: 3, surface: ice, pose: {xyz: [0.6, 0.07, 0]}, shapes: [{sphere: 0.05}]}\n"
      "joints:\n"
      "- {name: hinge, type: hinge, parent: frame, child: door, axis: [0, 0, 1]}\n"
      "- {name: rail, type: slider, parent: frame, child: cart, axis: [0, 1, 0], damping: 8}\n",
      GetParam()));
  const auto hinge = world.model().find_joint("hinge");
  const world::JointPlacement turning{hinge, 0.0, w};
  ASSERT_EQ(world.set_joints({&turning, 1}).text(), "");
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) {
    world.tick();
    const double a = world.state().joints[hinge.index()].position, s = std::sin(a), k = std::cos(a);
    EXPECT_NEAR(a, w * (i + 1) * kTick_s, 1e-9);
    if (i < 200) continue;  // the blow at the start has rung down
    const double v = w * (L + r * s) / (k * k), acc = w * w * (2 * L * s + r * (1 + s * s)) / (k * k * k);
    const double closed = (m * acc + c * v) / k;
    worst = std::max(worst, std::abs(force_on(world, "cart") / closed - 1.0));
    EXPECT_NEAR(state_of(world, "cart").p_WC.y(), L * s / k + r / k, 1e-3);
  }
  RecordProperty("worst_share", std::to_string(worst));
  EXPECT_LT(worst, 0.02) << "the force against the closed form, as a share of it";
}

TEST_P(Kinematic, ASkeletonMovesItsLimbsByItsJoints) {
  Simulation world(
      scene_of("bodies:\n"
               "- {name: trunk, kinematic: true, pose: {xyz: [0, 0, 1]}, shapes: [{box: [0.1, 0.1, 0.4]}]}\n"
               "- {name: arm, kinematic: true, pose: {xyz: [0.3, 0, 1]}, shapes: [{capsule: {radius: 0.04, "
               "length: 0.3}}]}\n"
               "- {name: hand, kinematic: true, pose: {xyz: [0.6, 0, 1]}, shapes: [{sphere: 0.05}]}\n"
               "joints:\n"
               "- {name: shoulder, type: hinge, parent: trunk, child: arm, axis: [0, 0, 1]}\n"
               "- {name: wrist, type: hinge, parent: arm, child: hand, axis: [0, 0, 1], limits: [-1, 1]}\n",
               GetParam()));
  const world::JointPlacement turning[] = {{world.model().find_joint("shoulder"), 0.0, 1.0},
                                           {world.model().find_joint("wrist"), 0.5, 2.0}};
  ASSERT_EQ(world.set_joints(turning).text(), "");
  ASSERT_TRUE(world.set_body(world.model().find_body("trunk"), {}, {0.5, 0, 0}, Vector3d::Zero()).done());
  run(world, 1000);
  EXPECT_NEAR(state_of(world, "trunk").p_WC.x(), 0.5, 1e-9);
  EXPECT_NEAR(world.state().joints[0].position, 1.0, 1e-9);
  EXPECT_NEAR(world.state().joints[1].position, 1.0, 1e-9) << "its stop";
  EXPECT_EQ(world.state().joints[1].velocity, 0.0) << "it has reached its stop";
  const auto joined = world::placing_fault(world.model(), world.model().find_body("hand"));
  EXPECT_THAT(joined, HasSubstr("hangs on the joint 'wrist'"));
}

INSTANTIATE_TEST_SUITE_P(Engines, Kinematic, ::testing::Values("impulse", "ode"),
                         [](const auto& info) { return std::string(info.param); });

TEST(KinematicScenes, RefuseWhatMeansNothing) {
  const auto fault_of = [](const std::string& text) {
    try {
      scene_of(text);
    } catch (const config::ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(fault_of("bodies: [{name: a, kinematic: true, mass: 1, shapes: [{sphere: 1}]}]"),
              HasSubstr("bodies[0].mass: means nothing for a body with 'kinematic: true'"));
  EXPECT_THAT(fault_of("bodies: [{name: a, kinematic: true, fixed: true}]"), HasSubstr("the body is fixed"));
  EXPECT_THAT(fault_of("bodies: [{name: a, kinematic: true}, {name: b, mass: 1, shapes: [{sphere: 1}]}]\n"
                       "joints: [{name: j, type: hinge, parent: a, child: b, axis: [0, 0, 1]}]"),
              HasSubstr("connects 'a', which is kinematic, with a body that is not"));
}

}  // namespace
}  // namespace visum::cycle
