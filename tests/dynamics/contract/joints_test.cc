#include <numbers>

#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {
namespace {

using world::JointKind;

class Joints : public Contract {
 protected:
  // A rotor, or a carriage, with the inertia 0.5, on a joint about or along x.
  world::Joint& add_single(ModelBuilder& b, JointKind kind) const {
    b.model.gravity.setZero();
    const BodyId rotor = b.add_rotor("rotor", 0.5, 0.5, at(0, 0, 1));
    return b.add_joint("joint", kind, {}, rotor, {0, 0, 1}, {1, 0, 0});
  }
};
VISUM_INSTANTIATE_CONTRACT(Joints);

TEST_P(Joints, AStopHoldsAgainstTorque) {
  for (const JointKind kind : {JointKind::kHinge, JointKind::kSlider}) {
    for (const double torque : {3.0, -3.0}) {
      auto b = builder();
      world::Joint& joint = add_single(b, kind);
      joint.limited = true;
      joint.lower = -0.2;
      joint.upper = 0.3;
      Lab lab(b.model);
      lab.drive("joint").feedforward = torque;
      lab.run(2.0);
      EXPECT_NEAR(lab.joint("joint").position, torque > 0 ? 0.3 : -0.2, 1e-4);
      EXPECT_NEAR(lab.joint("joint").velocity, 0.0, 1e-3);
    }
  }
}

TEST_P(Joints, AStopBeyondOneTurnHoldsToo) {
  for (const double stop : {350.0, 185.0, 179.9, 180.0, 720.0}) {
    for (const double side : {1.0, -1.0}) {
      auto b = builder();
      world::Joint& joint = add_single(b, JointKind::kHinge);
      joint.limited = true;
      joint.lower = -stop * std::numbers::pi / 180.0;
      joint.upper = stop * std::numbers::pi / 180.0;
      Lab lab(b.model);
      lab.drive("joint") = {side * 8.0, 1e-3, 20.0, 0.0};
      lab.run(3.0);
      EXPECT_NEAR(lab.joint("joint").position, side * stop * std::numbers::pi / 180.0, 1e-2) << stop;
      lab.drive("joint") = {-side * 8.0, 1e-3, 20.0, 0.0};
      lab.run(0.2);
      EXPECT_LT(side * lab.joint("joint").position, stop * std::numbers::pi / 180.0 - 0.5)
          << "it sticks to its stop";
    }
  }
}

TEST_P(Joints, AStateRestoredAwayFromAStopForgetsIt) {
  auto b = builder();
  world::Joint& joint = add_single(b, JointKind::kHinge);
  joint.limited = true;
  joint.lower = -2.0 * std::numbers::pi;
  joint.upper = 2.0 * std::numbers::pi;
  Lab lab(b.model);
  const world::WorldState start = lab.state;
  lab.drive("joint").feedforward = 5.0;
  lab.run(2.0);
  EXPECT_NEAR(lab.joint("joint").position, 2.0 * std::numbers::pi, 1e-3);
  lab.state = start;
  lab.drive("joint") = {1.0, 0.0, 100.0, 0.0};
  lab.run_ticks(100);
  EXPECT_NEAR(lab.joint("joint").velocity, 1.0, 1e-3);
}

TEST_P(Joints, AMotorPullsOffAStopWithItsFullEffort) {
  auto b = builder();
  world::Joint& joint = add_single(b, JointKind::kHinge);
  joint.limited = true;
  joint.lower = -0.1;
  joint.upper = 0.1;
  Lab lab(b.model);
  lab.drive("joint") = {5.0, 0.0, 2.0, 0.0};
  lab.run(1.0);
  EXPECT_NEAR(lab.joint("joint").position, 0.1, 1e-4);
  EXPECT_NEAR(lab.joint("joint").effort, 2.0, 1e-3) << "against the stop it pushes with all it has";
  lab.drive("joint") = {-5.0, 0.0, 2.0, 0.0};
  ASSERT_TRUE(lab.step().ok);
  EXPECT_NEAR(lab.joint("joint").effort, -2.0, 1e-3);
  ASSERT_TRUE(lab.step().ok);
  EXPECT_LT(lab.joint("joint").velocity, -1.9 * 2.0 / 0.5 * lab.tick_s());
}

TEST_P(Joints, AStopsRestitutionThrowsBack) {
  for (const JointKind kind : {JointKind::kHinge, JointKind::kSlider}) {
    auto b = builder();
    world::Joint& joint = add_single(b, kind);
    joint.limited = true;
    joint.lower = -1.0;
    joint.upper = 0.1;
    joint.stop_restitution = 0.6;
    Lab lab(b.model);
    lab.drive("joint") = {1.0, 0.0, 1e4, 0.0};
    ASSERT_TRUE(lab.step().ok);
    lab.drive("joint") = {};
    lab.run(0.2);
    EXPECT_NEAR(lab.joint("joint").velocity, -0.6, 0.05);
  }
}

TEST_P(Joints, AnUndrivenJointsDampingIsImplicit) {
  // v' = v / (1 + h d / J): stable however hard the damping is.
  for (const double damping : {0.1, 5.0, 5e4}) {
    auto b = builder();
    add_single(b, JointKind::kHinge).damping = damping;
    b.body({0}).w_WB = {2.0, 0, 0};
    Lab lab(b.model);
    double exact = 2.0;
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(lab.step().ok);
      exact /= 1.0 + lab.tick_s() * damping / 0.5;
      ASSERT_NEAR(lab.joint("joint").velocity, exact, 2.0 * accuracy().drive_law + 1e-7);
      ASSERT_NEAR(lab.joint("joint").effort, -damping * exact, 1e-3 * damping * exact + 1e-4 * damping);
    }
  }
}

TEST_P(Joints, AnUndrivenJointsFrictionBrakesEvenlyAndHolds) {
  auto b = builder();
  add_single(b, JointKind::kSlider).friction = 0.25;
  b.body({0}).v_WB = {1.0, 0, 0};
  Lab lab(b.model);
  lab.run(1.0);
  EXPECT_NEAR(lab.joint("joint").velocity, 1.0 - 0.25 / 0.5 * 1.0, 1e-3);
  lab.run(1.5);
  EXPECT_NEAR(lab.joint("joint").velocity, 0.0, 1e-6);
  lab.wrenches = {{{0}, {0.2, 0, 0}, Eigen::Vector3d::Zero()}};
  lab.run(0.5);
  EXPECT_NEAR(lab.joint("joint").velocity, 0.0, 1e-6);
}

TEST_P(Joints, TheModelsFrictionAndDampingRestWhileAPartDrives) {
  auto b = builder();
  world::Joint& joint = add_single(b, JointKind::kHinge);
  joint.friction = 10.0;
  joint.damping = 10.0;
  Lab lab(b.model);
  lab.drive("joint").feedforward = 0.5;
  lab.run(0.1);
  EXPECT_NEAR(lab.joint("joint").velocity, 0.5 / 0.5 * 0.1, 1e-6);
}

TEST_P(Joints, AFixedJointHoldsTwoBodiesTogether) {
  auto b = builder();
  const BodyId first = b.add_box("first", {0.2, 0.2, 0.2}, 1.0, at(0, 0, 0, 0.3, {1, 0, 1}));
  const BodyId second = b.add_box("second", {0.2, 0.2, 0.2}, 2.0, at(0.3, 0.1, 0));
  b.add_joint("weld", JointKind::kFixed, first, second, {0.1, 0, 0}, {0, 0, 1});
  b.body(first).w_WB = b.body(second).w_WB = {0, 0, 2.0};
  b.body(second).v_WB = Eigen::Vector3d(0, 0, 2.0).cross(Eigen::Vector3d(0.3, 0.1, 0));
  Lab lab(b.model);
  const Pose before = Pose{lab.body("first").p_WC, lab.body("first").q_WB}.inverse() *
                      Pose{lab.body("second").p_WC, lab.body("second").q_WB};
  lab.run(1.0);
  const Pose after = Pose{lab.body("first").p_WC, lab.body("first").q_WB}.inverse() *
                     Pose{lab.body("second").p_WC, lab.body("second").q_WB};
  EXPECT_LT((after.p - before.p).norm(), 1e-3);
  EXPECT_LT(after.q.angularDistance(before.q), 1e-3);
  EXPECT_EQ(lab.joint("weld").effort, 0.0);
}

TEST_P(Joints, AFixedJointToTheWorldHangsInTheAir) {
  auto b = builder();
  const BodyId lamp = b.add_box("lamp", {0.2, 0.2, 0.2}, 3.0, at(1, 2, 3, 0.3, {1, 0, 1}));
  b.add_joint("hook", JointKind::kFixed, {}, lamp, {1, 2, 3.5}, {0, 0, 1});
  Lab lab(b.model);
  lab.run(1.0);
  EXPECT_LT((lab.body("lamp").p_WC - Eigen::Vector3d(1, 2, 3)).norm(), 1e-4);
}

TEST_P(Joints, APendulumKeepsItsEnergyAndItsHinge) {
  auto b = builder();
  const BodyId rod = b.add_box("rod", {0.02, 0.02, 1.0}, 1.0, at(0.5, 0, 0, std::numbers::pi / 2, {0, 1, 0}));
  b.add_joint("hinge", JointKind::kHinge, {}, rod, {0, 0, 0}, {0, 1, 0});
  Lab lab(b.model);
  const double scale = 9.81 * 0.5;
  double worst = 0.0, lowest = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_TRUE(lab.step().ok);
    worst = std::max(worst, std::abs(lab.kinetic_energy() + 9.81 * lab.body("rod").p_WC.z()) / scale);
    lowest = std::min(lowest, lab.body("rod").p_WC.z());
    const Eigen::Vector3d anchor = lab.body("rod").p_WC + lab.body("rod").q_WB * Eigen::Vector3d(0, 0, -0.5);
    ASSERT_LT(anchor.norm(), accuracy().joint_gap_m);
  }
  EXPECT_LT(worst, accuracy().pendulum_energy);
  EXPECT_NEAR(lowest, -0.5, 1e-3);
}

TEST_P(Joints, AnInitialPositionIsCarriedOutByTheWholeSubtree) {
  auto b = builder();
  const BodyId first = b.add_box("first", {1.0, 0.1, 0.1}, 1.0, at(0.5, 0, 0));
  const BodyId second = b.add_box("second", {1.0, 0.1, 0.1}, 1.0, at(1.5, 0, 0));
  b.add_joint("one", JointKind::kHinge, {}, first, {0, 0, 0}, {0, 0, 1}).initial_position =
      std::numbers::pi / 2;
  b.add_joint("two", JointKind::kHinge, first, second, {1, 0, 0}, {0, 0, 1});
  b.model.gravity.setZero();
  Lab lab(b.model);
  EXPECT_LT((lab.body("second").p_WC - Eigen::Vector3d(0, 1.5, 0)).norm(), 1e-12);
  lab.run_ticks(10);
  EXPECT_NEAR(lab.joint("one").position, std::numbers::pi / 2, 1e-9);
  EXPECT_LT((lab.body("second").p_WC - Eigen::Vector3d(0, 1.5, 0)).norm(), 1e-9)
      << "the engine sees no error in it";
}

}  // namespace
}  // namespace visum::dynamics::testing
