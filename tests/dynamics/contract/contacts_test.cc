#include <cmath>
#include <numbers>

#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {
namespace {

using world::JointKind;
constexpr double kG = 9.81;
constexpr double kPi = std::numbers::pi;

class Contacts : public Contract {
 protected:
  // A box on a fixed slope about y. Returns the direction downhill.
  Eigen::Vector3d add_slope(ModelBuilder& b, double angle, double friction) const {
    const world::SurfaceId surface = b.add_surface(friction, 0.0);
    const Pose tilt = at(0, 0, 0, angle, {0, 1, 0});
    b.add_fixed_box("slope", {20, 20, 1}, tilt * at(0, 0, -0.5), surface);
    b.add_box("box", {0.2, 0.2, 0.2}, 1.0, tilt * at(0, 0, 0.1), surface);
    return tilt.q * Eigen::Vector3d::UnitX();
  }
};
VISUM_INSTANTIATE_CONTRACT(Contacts);

TEST_P(Contacts, ABoxAtRestIsCarriedByItsWeight) {
  auto b = builder();
  b.add_ground();
  b.add_box("box", {0.2, 0.3, 0.1}, 2.0, at(0, 0, 0.05));
  Lab lab(b.model);
  lab.run(1.0);
  EXPECT_NEAR(lab.normal_force_between("box", "ground"), 2.0 * kG, accuracy().contact_force * 2.0 * kG);
  EXPECT_NEAR(lab.body("box").p_WC.z(), 0.05, 1e-4);
}

TEST_P(Contacts, TheForceIsThatOfTheTickWhateverTheOrderOfTheShapes) {
  auto b = builder();
  b.add_box("box", {0.2, 0.3, 0.1}, 2.0, at(0, 0, 0.05));
  b.add_ground();
  Lab lab(b.model);
  lab.run(1.0);
  EXPECT_NEAR(lab.normal_force_between("box", "ground"), 2.0 * kG, accuracy().contact_force * 2.0 * kG);
  for (const auto& contact : lab.contacts) EXPECT_GT(contact.normal_W.z(), 0.99);
}

TEST_P(Contacts, EveryShapeRestsWithoutRocking) {
  const std::vector<Eigen::Vector3d> prism{{-0.1, -0.06, -0.1}, {0.1, -0.06, -0.1}, {0, 0.1, -0.1},
                                           {-0.1, -0.06, 0.1},  {0.1, -0.06, 0.1},  {0, 0.1, 0.1}};
  auto b = builder();
  b.add_fixed_box("table", {4, 4, 1}, at(0, 0, -0.5));
  b.add_box("box", {0.2, 0.2, 0.2}, 1.0, at(-1, 0, 0.1001));
  b.add_cylinder("can", 0.1, 0.2, 1.0, at(0, 0, 0.1001));
  b.add_hull("hull", prism, 1.0, at(1, 0, 0.1001));
  b.add_cylinder("lying", 0.1, 0.3, 1.0, at(0, 1, 0.1001, kPi / 2, {1, 0, 0}));
  Lab lab(b.model);
  lab.run(1.0);
  for (const char* name : {"box", "can", "hull", "lying"}) {
    const world::BodyState before = lab.body(name);
    lab.run(1.0);
    EXPECT_LT((lab.body(name).p_WC - before.p_WC).norm(), 1e-4) << name;
    EXPECT_LT(lab.body(name).q_WB.angularDistance(before.q_WB), 1e-4) << name;
    EXPECT_NEAR(lab.body(name).p_WC.z(), 0.1, 1e-3) << name;
    EXPECT_LT(lab.body(name).v_WC.norm(), 1e-3) << name;
  }
}

TEST_P(Contacts, OnASlopeTooSteepABoxSlidesAsCoulombSays) {
  auto b = builder();
  const double angle = kPi / 6, friction = 0.3;
  const Eigen::Vector3d downhill = add_slope(b, angle, friction);
  Lab lab(b.model);
  lab.run(0.2);
  const double v = lab.body("box").v_WC.dot(downhill);
  lab.run(1.0);
  const double acceleration = kG * (std::sin(angle) - friction * std::cos(angle));
  EXPECT_NEAR(lab.body("box").v_WC.dot(downhill) - v, acceleration, accuracy().slide * acceleration);
}

TEST_P(Contacts, FrictionBrakesTheSameInEveryDirection) {
  for (const double heading : {0.0, 0.3, kPi / 4, 1.0}) {
    auto b = builder();
    const world::SurfaceId surface = b.add_surface(0.3, 0.0);
    b.add_ground(surface);
    const BodyId box = b.add_box("box", {0.2, 0.2, 0.1}, 1.0, at(0, 0, 0.05), surface);
    b.body(box).v_WB = {2.0 * std::cos(heading), 2.0 * std::sin(heading), 0};
    Lab lab(b.model);
    lab.run(1.5);
    const double stop = 2.0 * 2.0 / (2.0 * 0.3 * kG);
    EXPECT_NEAR(lab.body("box").p_WC.head<2>().norm(), stop, 0.03 * stop) << heading;
  }
}

TEST_P(Contacts, OnAGentleSlopeABoxSticks) {
  auto b = builder();
  const Eigen::Vector3d downhill = add_slope(b, kPi / 9, 0.5);
  Lab lab(b.model);
  lab.run(1.0);
  const double before = lab.body("box").p_WC.dot(downhill);
  lab.run(2.0);
  EXPECT_LT(std::abs(lab.body("box").p_WC.dot(downhill) - before), 2.0 * accuracy().creep_m_per_s);
}

TEST_P(Contacts, ABallBouncesToTheSquareOfTheRestitution) {
  for (const double restitution : {0.0, 0.5, 0.8}) {
    auto b = builder();
    const world::SurfaceId surface = b.add_surface(0.5, restitution);
    b.add_ground(surface);
    b.add_sphere("ball", 0.1, 1.0, at(0, 0, 1.1), surface);
    Lab lab(b.model);
    lab.run(std::sqrt(2.0 / kG) + 0.01);
    double apex = 0.0;
    for (int i = 0; i < 900; ++i) {
      lab.run_ticks(1);
      apex = std::max(apex, lab.body("ball").p_WC.z() - 0.1);
    }
    EXPECT_NEAR(apex, restitution * restitution, 0.02) << restitution;
  }
}

TEST_P(Contacts, ARollingBallRollsWithoutSlipping) {
  auto b = builder();
  b.add_ground();
  const BodyId ball = b.add_sphere("ball", 0.1, 1.0, at(0, 0, 0.1));
  b.body(ball).v_WB = {1.0, 0, 0};
  Lab lab(b.model);
  lab.run(1.0);
  EXPECT_NEAR(lab.body("ball").v_WC.x(), 5.0 / 7.0, 5e-3);
  EXPECT_NEAR(lab.body("ball").w_WB.y(), 5.0 / 7.0 / 0.1, 5e-2);
}

// A torque of c N against rolling, N = m g: (1 + 2/5) m a = c m g/r, s = v²/(2 a).
TEST_P(Contacts, ABallRollsToRestAsItsRollingFrictionSays) {
  auto b = builder();
  const world::SurfaceId felt = b.add_surface(0.8, 0.0);
  b.model.surfaces[felt.index()].rolling_friction = 0.01;
  b.add_ground(felt);
  const double r = 0.1, v = 0.7;
  const BodyId ball = b.add_sphere("ball", r, 1.0, at(0, 0, r));
  b.body(ball).v_WB = {v, 0, 0};
  b.body(ball).w_WB = {0, v / r, 0};
  const double a = 5.0 / 7.0 * kG * 0.01 / r;
  Lab lab(b.model);
  lab.run(0.5);
  EXPECT_NEAR(lab.body("ball").v_WC.x(), v - 0.5 * a, 5e-3 * v);
  EXPECT_NEAR(lab.body("ball").w_WB.y(), lab.body("ball").v_WC.x() / r, 1e-3);
  lab.run(1.0);
  const double stop = v * v / (2.0 * a);
  EXPECT_NEAR(lab.body("ball").p_WC.x(), stop, 5e-3 * stop);
  EXPECT_LT(lab.body("ball").v_WC.norm(), 1e-4);
  EXPECT_NEAR(lab.body("ball").p_WC.y(), 0.0, 1e-6);
}

// A torque of c N about the normal: the spin falls evenly, w = w0 - c m g/I t.
TEST_P(Contacts, ASpinningBallSlowsEvenlyAsItsTorsionalFrictionSays) {
  auto b = builder();
  const world::SurfaceId felt = b.add_surface(0.8, 0.0);
  b.model.surfaces[felt.index()].torsional_friction = 0.002;
  b.add_ground(felt);
  const double r = 0.1;
  const BodyId ball = b.add_sphere("ball", r, 1.0, at(0, 0, r));
  b.body(ball).w_WB = {0, 0, 6.0};
  const double slowing = 0.002 * kG / (0.4 * r * r);
  Lab lab(b.model);
  for (const double t : {0.25, 0.5, 1.0}) {
    lab.run(t - 1e-9 * static_cast<double>(lab.state.tick * lab.model.tick_ns));
    EXPECT_NEAR(lab.body("ball").w_WB.z(), 6.0 - slowing * t, 0.02) << t;
  }
  lab.run(0.5);
  EXPECT_LT(lab.body("ball").w_WB.norm(), 1e-3);
  EXPECT_LT(lab.body("ball").p_WC.head<2>().norm(), 1e-4);
}

// On a slope a ball rolls if sin(angle) r > c cos(angle), and stays otherwise.
TEST_P(Contacts, RollingFrictionHoldsABallOnAGentleSlope) {
  const double r = 0.1, limit = std::atan2(0.01, r);
  for (const double share : {0.9, 1.2}) {
    auto b = builder();
    const world::SurfaceId felt = b.add_surface(0.8, 0.0);
    b.model.surfaces[felt.index()].rolling_friction = 0.01;
    const Pose tilt = at(0, 0, 0, share * limit, {0, 1, 0});
    b.add_fixed_box("slope", {20, 20, 1}, tilt * at(0, 0, -0.5), felt);
    b.add_sphere("ball", r, 1.0, tilt * at(0, 0, r), felt);
    Lab lab(b.model);
    const Eigen::Vector3d start = lab.body("ball").p_WC;
    lab.run(1.0);
    const double rolled = (lab.body("ball").p_WC - start).norm(), angle = share * limit;
    const double a = 5.0 / 7.0 * kG * (std::sin(angle) - 0.01 / r * std::cos(angle));
    EXPECT_NEAR(rolled, share < 1.0 ? 0.0 : 0.5 * a, 2e-3) << share;
  }
}

TEST_P(Contacts, AStackOfFiveBoxesStands) {
  auto b = builder();
  b.add_ground();
  for (int i = 0; i < 5; ++i)
    b.add_box("box_" + std::to_string(i), {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0.05 + 0.1 * i));
  Lab lab(b.model);
  lab.run(10.0);
  for (int i = 0; i < 5; ++i) {
    const world::BodyState& box = lab.body("box_" + std::to_string(i));
    EXPECT_LT(box.p_WC.head<2>().norm(), accuracy().stack_drift_m) << i;
    EXPECT_NEAR(box.p_WC.z(), 0.05 + 0.1 * i, 2e-3) << i;
  }
  EXPECT_NEAR(lab.normal_force_between("box_0", "ground"), 5.0 * kG, accuracy().contact_force * 5.0 * kG);
}

TEST_P(Contacts, ABoxBetweenTwoSlidingJawsIsHeldAndLetGo) {
  auto b = builder();
  const world::SurfaceId grip = b.add_surface(0.8, 0.0);
  const BodyId left = b.add_box("left", {0.02, 0.05, 0.05}, 0.3, at(-0.06, 0, 1), grip);
  const BodyId right = b.add_box("right", {0.02, 0.05, 0.05}, 0.3, at(0.06, 0, 1), grip);
  b.add_box("box", {0.09, 0.05, 0.1}, 0.5, at(0, 0, 1), grip);
  b.add_joint("jaw_left", JointKind::kSlider, {}, left, {-0.06, 0, 1}, {1, 0, 0});
  b.add_joint("jaw_right", JointKind::kSlider, {}, right, {0.06, 0, 1}, {-1, 0, 0});
  Lab lab(b.model);
  for (const char* jaw : {"jaw_left", "jaw_right"}) lab.drive(jaw) = {0.5, 1e-3, 40.0, 0.0};
  lab.run(0.5);
  const Eigen::Vector3d held = lab.body("box").p_WC;
  EXPECT_GT(held.z(), 0.97) << "it slipped before the jaws closed";
  lab.run(5.0);
  EXPECT_LT((lab.body("box").p_WC - held).norm(), accuracy().grasp_slip_m);
  EXPECT_NEAR(lab.normal_force_between("box", "left"), 40.0, 40.0 * accuracy().contact_force + 0.1);
  for (const char* jaw : {"jaw_left", "jaw_right"}) lab.drive(jaw) = {-0.5, 1e-3, 40.0, 0.0};
  lab.run(0.5);
  EXPECT_LT(lab.body("box").p_WC.z(), 0.5);
}

TEST_P(Contacts, WhatOverlapsAtTheStartIsNotShotOut) {
  auto b = builder();
  b.add_ground();
  b.add_box("box", {0.2, 0.2, 0.2}, 1.0, at(0, 0, 0.0));
  Lab lab(b.model);
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(lab.step().ok);
    ASSERT_LT(lab.body("box").v_WC.norm(), 1.0);
  }
  EXPECT_NEAR(lab.body("box").p_WC.z(), 0.1, 1e-3);
}

}  // namespace
}  // namespace visum::dynamics::testing
