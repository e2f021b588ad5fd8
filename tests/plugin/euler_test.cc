// The engine of tests/install/outside, against closed forms. What it claims to do is right, and it refuses
// the rest.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/plugin/plugged_scene.h"

namespace visum {
namespace {

using test::error_of_scene;
using test::output_of;
using test::run;
using test::scene_of;

constexpr double kG = 9.81, kTick_s = 1e-3;
const std::string kEuler = "plugins: [euler, kinds]\nengine: euler\n";

TEST(OutsideEngine, AFreeBodyFallsAsTheMethodSays) {
  cycle::Simulation simulation(
      scene_of(kEuler + "bodies: [{name: ball, mass: 2, inertia: [1, 1, 1, 0, 0, 0], com: [0.1, 0, 0],"
                        " velocity: {linear: [3, 0, 0]}}]"));
  run(simulation, 1000);
  const auto& ball = simulation.state().bodies[0];
  EXPECT_NEAR(ball.v_WC.z(), -kG, 1e-9);
  EXPECT_NEAR(ball.p_WC.x(), 0.1 + 3.0, 1e-9);
  // Semi-implicit: z = -g h^2 n (n + 1) / 2.
  EXPECT_NEAR(ball.p_WC.z(), -kG * kTick_s * kTick_s * 1000 * 1001 / 2, 1e-9);
}

TEST(OutsideEngine, ABodySpinsOnWithItsAngularMomentum) {
  cycle::Simulation simulation(
      scene_of(kEuler +
               "gravity: [0, 0, 0]\nbodies: [{name: top, mass: 1, inertia: [0.1, 0.2, 0.25, 0, 0, 0],"
               " velocity: {angular: [0.5, 0.2, 3]}}]"));
  const auto momentum = [&] {
    const auto& top = simulation.state().bodies[0];
    const Eigen::Matrix3d R = top.q_WB.toRotationMatrix();
    return Eigen::Vector3d(R * simulation.model().bodies[0].inertia_C * R.transpose() * top.w_WB);
  };
  const Eigen::Vector3d before = momentum();
  run(simulation, 2000);
  EXPECT_LT((momentum() - before).norm(), 2e-3 * before.norm());
}

// A rod of 1 kg and 0.6 m, hinged at its end.
const std::string kPendulum = R"(
bodies: [{name: rod, mass: 1, inertia: [0.03, 0.03, 0.0001, 0, 0, 0], com: [0, 0, -0.3]}]
joints: [{name: hinge, type: hinge, child: rod, axis: [1, 0, 0], position: 0.05}]
)";

TEST(OutsideEngine, APendulumSwingsWithItsPeriod) {
  cycle::Simulation simulation(scene_of(kEuler + kPendulum));
  const double period = 2.0 * M_PI * std::sqrt((0.03 + 0.3 * 0.3) / (kG * 0.3)) * (1.0 + 0.05 * 0.05 / 16.0);
  const auto& angle = simulation.state().joints[0].position;
  int crossings = 0;
  double last = angle, began_s = 0.0, ended_s = 0.0, gap = 0.0;
  while (crossings < 11) {
    simulation.tick();
    ASSERT_LT(simulation.tick_count(), 20'000);
    const auto& rod = simulation.state().bodies[0];
    gap = std::max(gap, (rod.p_WC + rod.q_WB * Eigen::Vector3d(0, 0, 0.3)).norm());
    if ((last > 0.0) != (angle > 0.0)) {
      const double at_s = kTick_s * (static_cast<double>(simulation.tick_count()) - angle / (angle - last));
      (crossings++ == 0 ? began_s : ended_s) = at_s;
    }
    last = angle;
  }
  EXPECT_NEAR((ended_s - began_s) / 5.0, period, 1e-3 * period);
  EXPECT_LT(gap, 1e-5);
}

TEST(OutsideEngine, ATorqueTurnsARotorAndIsTold) {
  cycle::Simulation simulation(scene_of(kEuler + R"(
bodies: [{name: rotor, mass: 1, inertia: [0.02, 0.02, 0.02, 0, 0, 0]}]
joints: [{name: hinge, type: hinge, child: rotor, axis: [1, 0, 0]}]
parts: [{name: motor, kind: motor, joints: [hinge]}]
)"));
  simulation.write_inputs(0, 0, std::vector{0.02});
  run(simulation, 1000);
  EXPECT_NEAR(simulation.state().joints[0].position, 0.5, 1e-3);
  EXPECT_NEAR(simulation.state().joints[0].velocity, 1.0, 1e-9);
  EXPECT_NEAR(simulation.state().joints[0].effort, 0.02, 1e-12);
}

// Two carts of 1 and 3 kg on one rail. A force of 6 N between them pushes them apart.
TEST(OutsideEngine, ASliderBetweenBodiesKeepsTheirMomentum) {
  cycle::Simulation simulation(scene_of(kEuler + R"(
gravity: [0, 0, 0]
bodies:
  - {name: heavy, mass: 3, inertia: [1, 1, 1, 0, 0, 0]}
  - {name: light, mass: 1, inertia: [1, 1, 1, 0, 0, 0], pose: {xyz: [1, 0, 0]}}
joints: [{name: rail, type: slider, parent: heavy, child: light, pose: {xyz: [1, 0, 0]}, axis: [1, 0, 0]}]
parts: [{name: motor, kind: motor, joints: [rail]}]
)"));
  simulation.write_inputs(0, 0, std::vector{6.0});
  run(simulation, 500);
  EXPECT_NEAR(simulation.state().bodies[1].v_WC.x(), 6.0 / 1.0 * 0.5, 1e-9);
  EXPECT_NEAR(simulation.state().bodies[0].v_WC.x(), -6.0 / 3.0 * 0.5, 1e-9);
  EXPECT_NEAR(simulation.state().joints[0].velocity, 4.0, 1e-9);
}

TEST(OutsideEngine, RefusesWhatItCannotHold) {
  const std::string rod = kEuler + "bodies: [{name: rod, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}]\n";
  EXPECT_EQ(error_of_scene(rod + "joints: [{name: j, type: ball, child: rod}]"),
            "s.yaml:3: engine: euler: joint 'j' is of kind ball; this engine holds hinge and slider");
  EXPECT_EQ(
      error_of_scene(rod + "joints: [{name: j, type: hinge, child: rod, axis: [1, 0, 0], limits: [-1, 1]}]"),
      "s.yaml:3: engine: euler: joint 'j' has stops, which this engine does not hold");
  EXPECT_EQ(
      error_of_scene(rod + "joints: [{name: j, type: hinge, child: rod, axis: [1, 0, 0], friction: 1}]"),
      "s.yaml:3: engine: euler: joint 'j' has friction or damping, which this engine does not know");
}

TEST(OutsideEngine, FreezesTheWorldAtAContactThatItDoesNotKnow) {
  cycle::Simulation simulation(scene_of(kEuler + R"(
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: ball, density: 1000, pose: {xyz: [0, 0, 0.15]}, shapes: [{sphere: 0.1}]}
)"));
  run(simulation, 200);
  EXPECT_TRUE(simulation.frozen());
  EXPECT_EQ(simulation.fault(), "engine 'euler': knows no contacts: body 'floor' touches body 'ball'");
  EXPECT_GT(simulation.state().bodies[1].p_WC.z(), 0.099);
}

}  // namespace
}  // namespace visum
