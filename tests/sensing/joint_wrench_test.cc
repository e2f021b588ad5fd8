// Force and torque through joints, with both engines, against closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensing/world_bench.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;
using test::WorldBench;

class JointWrench : public testing::TestWithParam<const char*> {
 protected:
  static std::string engine() { return std::string("engine: ") + GetParam() + "\n"; }
  static Vector3d force(const WorldBench& bench) { return bench.axes("cell", "Force"); }
  static Vector3d torque(const WorldBench& bench) { return bench.axes("cell", "Torque"); }
};

// 2 kg hang 0.3 m beside a fixed joint: it pulls up with m g and holds m g r against the turn.
TEST_P(JointWrench, OfAHangingMass) {
  WorldBench bench(engine() + R"(
bodies: [{name: mass, mass: 2, pose: {xyz: [0.3, 0, 1]}, shapes: [{sphere: 0.05}]}]
joints: [{name: wrist, type: fixed, child: mass, pose: {xyz: [0, 0, 1]}}]
sensors: [{name: cell, kind: joint_wrench, joint: wrist}]
)");
  bench.run(1000);
  EXPECT_NEAR((force(bench) - Vector3d(0, 0, 2 * 9.81)).norm(), 0.0, 1e-3) << force(bench);
  EXPECT_NEAR((torque(bench) - Vector3d(0, -2 * 9.81 * 0.3, 0)).norm(), 0.0, 1e-3) << torque(bench);
}

// Two masses in a row: the upper joint carries both.
TEST_P(JointWrench, OfAllThatHangsOnTheJoint) {
  WorldBench bench(engine() + R"(
bodies:
  - {name: upper, mass: 1, pose: {xyz: [0, 0, 2]}, shapes: [{sphere: 0.05}]}
  - {name: lower, mass: 3, pose: {xyz: [0, 0, 1]}, shapes: [{sphere: 0.05}]}
joints:
  - {name: first, type: ball, child: upper, pose: {xyz: [0, 0, 3]}}
  - {name: second, type: ball, parent: upper, child: lower, pose: {xyz: [0, 0, -0.5]}}
sensors:
  - {name: cell, kind: joint_wrench, joint: first}
  - {name: below, kind: joint_wrench, joint: second}
)");
  bench.run(1000);
  EXPECT_NEAR((force(bench) - Vector3d(0, 0, 4 * 9.81)).norm(), 0.0, 1e-3);
  EXPECT_NEAR((bench.axes("below", "Force") - Vector3d(0, 0, 3 * 9.81)).norm(), 0.0, 1e-3);
}

// A pendulum let go at 90°: at the bottom the joint pulls with m g (1 + 2 / (1 + I / m r²)).
TEST_P(JointWrench, OfASwingingMassAtTheBottom) {
  WorldBench bench(engine() + R"(
bodies: [{name: bob, mass: 2, inertia: [0.002, 0.002, 0.002, 0, 0, 0], pose: {xyz: [1, 0, 0]}, shapes: [{sphere: 0.05}]}]
joints: [{name: pivot, type: hinge, child: bob, axis: [0, 1, 0]}]
sensors: [{name: cell, kind: joint_wrench, joint: pivot}]
)");
  double highest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    bench.run(1);
    highest = std::max(highest, force(bench).norm());
  }
  EXPECT_NEAR(highest, 2 * 9.81 * (1 + 2 / (1 + 0.002 / 2.0)), 0.1);
}

// A plate on a scale, and a block that slides over it: weight, and friction along the motion.
TEST_P(JointWrench, OfAPlateOverWhichABlockSlides) {
  WorldBench bench(engine() + R"(
surfaces: {default: {friction: 0.3}}
bodies:
  - {name: plate, mass: 1, shapes: [{box: [20, 1, 0.1]}]}
  - {name: block, mass: 2, pose: {xyz: [-5, 0, 0.1]}, velocity: {linear: [6, 0, 0]}, shapes: [{box: [0.2, 0.2, 0.1]}]}
joints: [{name: foot, type: fixed, child: plate}]
sensors: [{name: cell, kind: joint_wrench, joint: foot}]
)");
  bench.run(500);
  Vector3d mean = Vector3d::Zero();
  for (int i = 0; i < 500; ++i) {
    bench.run(1);
    mean += force(bench) / 500;
  }
  EXPECT_NEAR(mean.z(), 3 * 9.81, 0.1);
  EXPECT_NEAR(mean.x(), -0.3 * 2 * 9.81, 0.1) << "the joint holds the plate back";
}

// A ball that spins on a plate: a torque of c N about the normal, which no force carries. Then one that rolls
// over it: c N about the horizontal.
TEST_P(JointWrench, OfAPlateOnWhichABallSpinsOrRolls) {
  const auto plate_under = [&](const std::string& surface, const std::string& velocity) {
    return engine() + "surfaces: {default: {friction: 0.8, " + surface +
           ": 0.01}}\nbodies:\n"
           "  - {name: plate, mass: 1, shapes: [{box: [4, 4, 0.1]}]}\n"
           "  - {name: ball, mass: 2, pose: {xyz: [0, 0, 0.15]}, velocity: " +
           velocity +
           ", shapes: [{sphere: 0.1}]}\n"
           "joints: [{name: foot, type: fixed, child: plate}]\n"
           "sensors: [{name: cell, kind: joint_wrench, joint: foot}, {name: ball, kind: pose, body: ball}]\n";
  };
  const auto mean_torque = [&](WorldBench& bench) {
    bench.run(200);
    Vector3d mean = Vector3d::Zero();
    for (int i = 0; i < 100; ++i) {
      // Less that of the force, about the plate's middle: it acts where the ball was when the tick began.
      const Vector3d at(bench.port("ball", "Position X"), bench.port("ball", "Position Y"), 0.05);
      bench.run(1);
      mean += (torque(bench) - at.cross(force(bench) - Vector3d(0, 0, 9.81))) / 100;
    }
    return mean;
  };
  WorldBench spins(plate_under("torsional_friction", "{angular: [0, 0, 50]}"));
  EXPECT_NEAR(mean_torque(spins).z(), -0.01 * 2 * 9.81, 0.01);
  WorldBench rolls(plate_under("rolling_friction", "{linear: [1, 0, 0], angular: [0, 10, 0]}"));
  EXPECT_NEAR(mean_torque(rolls).y(), -0.01 * 2 * 9.81, 0.01);
}

TEST_P(JointWrench, LessWhatAPushCarries) {
  WorldBench bench(engine() + R"(
bodies: [{name: mass, mass: 2, pose: {xyz: [0.3, 0, 1]}, shapes: [{sphere: 0.05}]}]
joints: [{name: wrist, type: fixed, child: mass, pose: {xyz: [0, 0, 1]}}]
sensors: [{name: cell, kind: joint_wrench, joint: wrist}]
)");
  ASSERT_TRUE(bench.simulation.push({{{0}, {5, 0, 2 * 9.81}, {0, 0, 1}}, 100'000}).done());
  bench.run(1000);
  EXPECT_NEAR((force(bench) - Vector3d(-5, 0, 0)).norm(), 0.0, 1e-3);
  EXPECT_NEAR((torque(bench) - Vector3d(0, 0, -1)).norm(), 0.0, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Engines, JointWrench, testing::Values("impulse", "ode"),
                         [](const auto& info) { return std::string(info.param); });

std::string error_of(const std::string& joints) {
  const visum::test::TempFiles files;
  const auto file = files.write("s.yaml", R"(visum: 1
engine: impulse
bodies: [{name: a, mass: 1, shapes: [{sphere: 0.1}]}, {name: b, mass: 1, pose: {xyz: [1, 0, 0]}, shapes: [{sphere: 0.1}]}]
joints:
)" + joints + "\n");
  return files.error_of([&] { cycle::Simulation simulation(scene::load_scene(file)); });
}

TEST(JointWrenchInAScene, IsRefusedWhereItCannotBeTold) {
  EXPECT_EQ(
      error_of(R"(- {name: up, type: ball, child: a}
- {name: across, type: ball, parent: a, child: b}
- {name: back, type: point_on_line, child: b, axis: [1, 0, 0]}
sensors: [{name: cell, kind: joint_wrench, joint: up}])"),
      "s.yaml:8: sensors[0].joint: joint 'back' carries the load, too: only a joint that carries alone can "
      "be measured");
  EXPECT_EQ(
      error_of(R"(- {name: spring, type: spring, child: a, child_point: [0, 0, 0], stiffness: 1, rest: 1}
sensors: [{name: cell, kind: joint_wrench, joint: spring}])"),
      "s.yaml:6: sensors[0].joint: joint 'spring' holds nothing: there is no force to measure");
  EXPECT_EQ(error_of(R"(- {name: up, type: ball, child: a}
sensors: [{name: cell, kind: joint_wrench}])"),
            "s.yaml:6: sensors[0]: a joint_wrench sensor needs 'joint'");
  EXPECT_EQ(error_of(R"(- {name: up, type: ball, child: a}
sensors: [{name: cell, kind: joint_wrench, joint: up, body: a}])"),
            "s.yaml:6: sensors[0]: unknown key 'body'");
}

}  // namespace
}  // namespace visum::sensing
