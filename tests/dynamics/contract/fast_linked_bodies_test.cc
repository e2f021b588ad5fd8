// Bodies that joints hold do not pass through others either, when they move by more than their own thickness
// within a tick: with any engine that may make a tick in parts.
#include <cmath>
#include <numbers>

#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {
namespace {

constexpr double kSheetM = 0.01;
constexpr double kRadiusM = 0.02;
constexpr double kBallKg = 0.26;
constexpr double kSpeed = 130.0;  // m/s: 0.13 m in a tick
constexpr double kAtPlateM = -kRadiusM - 0.5 * kSheetM;

class FastLinkedBodies : public Contract {
 protected:
  void SetUp() override {
    if (!Lab(builder().model).engines.front()->may_repeat()) GTEST_SKIP() << "is called once in a tick";
  }

  // A ball on a slider along x, which flies at a plate at x = 0.
  ModelBuilder shot(double start_x, double restitution = 0.0) const {
    auto b = builder();
    b.model.gravity.setZero();
    const world::SurfaceId surface = b.add_surface(0.3, restitution);
    b.add_fixed_box("plate", {kSheetM, 2, 2}, at(0, 0, 0), surface);
    const BodyId ball = b.add_sphere("ball", kRadiusM, kBallKg, at(start_x, 0, 0), surface);
    b.body(ball).v_WB = {kSpeed, 0, 0};
    b.add_joint("rail", world::JointKind::kSlider, {}, ball, {start_x, 0, 0}, {1, 0, 0});
    return b;
  }
};
VISUM_INSTANTIATE_CONTRACT(FastLinkedBodies);

TEST_P(FastLinkedBodies, ABallOnARailDoesNotPassThroughAThinPlate) {
  for (int i = 0; i < 26; ++i) {
    const double start = -1.0 - 0.005 * i;
    Lab lab(shot(start).model);
    lab.run_ticks(30);
    EXPECT_NEAR(lab.body("ball").p_WC.x(), kAtPlateM, 1e-3) << "from " << start;
    EXPECT_LT(lab.body("ball").v_WC.norm(), 1.0) << "from " << start;
    EXPECT_NEAR(lab.joint("rail").position, kAtPlateM - start, 1e-3) << "from " << start;
    EXPECT_EQ(lab.warned_ticks, 0) << "from " << start;
  }
}

TEST_P(FastLinkedBodies, WithoutContinuousCollisionItDoes) {
  auto b = shot(-1.0);
  b.model.continuous_collision = false;
  Lab lab(b.model);
  lab.run_ticks(30);
  EXPECT_GT(lab.body("ball").p_WC.x(), 1.0);
}

// It bounces within the tick: no time is lost at the plate.
TEST_P(FastLinkedBodies, ABallOnARailBouncesOffAtOnce) {
  Lab lab(shot(-1.0, 1.0).model);
  const int ticks = 30;
  lab.run_ticks(ticks);
  EXPECT_NEAR(lab.body("ball").v_WC.x(), -kSpeed, 0.02 * kSpeed);
  const double way = ticks * 1e-3 * kSpeed;
  EXPECT_NEAR(lab.body("ball").p_WC.x(), 2.0 * kAtPlateM + 1.0 - way, 0.02 * way);
}

// The forces of the parts are means over the tick: together they are what stopped the ball.
TEST_P(FastLinkedBodies, TheForcesOfTheHitAddUpToItsImpulse) {
  Lab lab(shot(-1.03).model);
  double impulse = 0.0;
  for (int i = 0; i < 30; ++i) {
    lab.run_ticks(1);
    impulse += lab.normal_force_between("ball", "plate") * lab.tick_s();
  }
  EXPECT_NEAR(impulse, kBallKg * kSpeed, 0.02 * kBallKg * kSpeed);
}

// A hammer of 1 m: its head moves on a circle, as far as the engine holds it there without a plate.
TEST_P(FastLinkedBodies, AHammerDoesNotSwingThroughAPlate) {
  const auto swing = [&](double angle, bool plate) {
    auto b = builder();
    b.model.gravity.setZero();
    if (plate) b.add_fixed_box("plate", {0.5, kSheetM, 0.5}, at(1, 0, 0));
    const BodyId hammer = b.add_sphere("hammer", kRadiusM, kBallKg, at(std::cos(angle), -std::sin(angle), 0));
    b.body(hammer).v_WB = kSpeed * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0);
    b.body(hammer).w_WB = {0, 0, kSpeed};
    b.add_joint("pivot", world::JointKind::kHinge, {}, hammer, {0, 0, 0}, {0, 0, 1});
    Lab lab(b.model);
    double farthest = 0.0;
    for (int k = 0; k < 30; ++k) {
      lab.run_ticks(1);
      EXPECT_TRUE(!plate || lab.body("hammer").p_WC.y() < 0.0) << angle << " tick " << k;
      farthest = std::max(farthest, std::abs(lab.body("hammer").p_WC.norm() - 1.0));
    }
    // ODE's joint, which has come apart in the swing, pulls the head back a little after the hit.
    EXPECT_TRUE(!plate || lab.body("hammer").v_WC.norm() < 0.05 * kSpeed) << angle;
    return farthest;
  };
  for (int i = 0; i < 12; ++i) {
    const double before_the_plate = 0.3 + 0.011 * i;
    EXPECT_LT(swing(before_the_plate, true), swing(before_the_plate, false) + 1e-4) << before_the_plate;
  }
}

TEST_P(FastLinkedBodies, TwoOnRailsThatMeetDoNotSwapPlaces) {
  auto b = builder();
  b.model.gravity.setZero();
  const BodyId left = b.add_sphere("left", kRadiusM, kBallKg, at(-1, 0, 0));
  const BodyId right = b.add_sphere("right", kRadiusM, kBallKg, at(1, 0, 0));
  b.body(left).v_WB = {kSpeed, 0, 0};
  b.body(right).v_WB = {-kSpeed, 0, 0};
  b.add_joint("first", world::JointKind::kSlider, {}, left, {-1, 0, 0}, {1, 0, 0});
  b.add_joint("second", world::JointKind::kSlider, {}, right, {1, 0, 0}, {1, 0, 0});
  Lab lab(b.model);
  lab.run_ticks(30);
  EXPECT_LT(lab.body("left").p_WC.x() + kRadiusM, lab.body("right").p_WC.x());
  EXPECT_LT(lab.kinetic_energy(), 0.05 * kBallKg * kSpeed * kSpeed);
}

// A tray on a rail, with a box on it that nothing holds but friction. Before the tray hits the plate, the box
// has moved with it, also in the part of the tick before the hit.
TEST_P(FastLinkedBodies, WhatIsCarriedComesAlongUpToTheHit) {
  auto b = builder();
  const BodyId tray = b.add_box("tray", {0.2, 0.2, 0.02}, 5.0, at(-0.5, 0, 0));
  const BodyId box = b.add_box("box", {0.05, 0.05, 0.05}, 0.1, at(-0.5, 0, 0.035));
  b.add_fixed_box("plate", {kSheetM, 2, 0.01}, at(0, 0, 0));
  for (const BodyId id : {tray, box}) b.body(id).v_WB = {60.0, 0, 0};
  b.add_joint("rail", world::JointKind::kSlider, {}, tray, {-0.5, 0, 0}, {1, 0, 0});
  Lab lab(b.model);
  int ticks = 0;
  while (lab.body("tray").v_WC.x() > 30.0 && ++ticks < 30) {
    EXPECT_NEAR(lab.body("box").p_WC.x(), lab.body("tray").p_WC.x(), 1e-3) << ticks;
    lab.run_ticks(1);
  }
  // It goes on where the tray has stopped, from where the tray has carried it.
  EXPECT_NEAR(lab.body("tray").p_WC.x(), -0.1 - 0.5 * kSheetM, 2e-3);
  EXPECT_NEAR(lab.body("box").p_WC.x(), -0.5 + 0.06 * ticks, 2e-3);
}

// A body that falls elsewhere does not notice that the tick is made in parts.
TEST_P(FastLinkedBodies, OthersGoOnAsTheyWould) {
  const auto fall = [&](bool plate) {
    auto b = shot(plate ? -1.03 : -100.0);
    b.model.gravity = {0, 0, -9.81};
    b.add_sphere("other", 0.1, 1.0, at(0, 50, 0));
    Lab lab(b.model);
    lab.run_ticks(30);
    return lab.body("other").p_WC.z();
  };
  EXPECT_NEAR(fall(true), fall(false), 2e-6);
}

// A miss is a miss: as if the plate were not there, to the bit.
TEST_P(FastLinkedBodies, ABallThatFliesPastIsNotTouched) {
  const auto flight = [&](double plate_y) {
    auto b = builder();
    b.add_fixed_box("plate", {kSheetM, 1, 1}, at(0, plate_y, 0));
    const BodyId ball = b.add_sphere("ball", kRadiusM, kBallKg, at(-1, 0, 0));
    b.body(ball).v_WB = {kSpeed, 0, 0};
    b.add_joint("rail", world::JointKind::kSlider, {}, ball, {-1, 0, 0}, {1, 0, 0});
    Lab lab(b.model);
    lab.run_ticks(30);
    return lab.body("ball").p_WC;
  };
  EXPECT_EQ(flight(0.5 + kRadiusM + 1e-3), flight(100.0));
}

// A blade that turns fast beside a wall never comes nearer, and is left alone.
TEST_P(FastLinkedBodies, ARotorBesideAWallTurnsOn) {
  const auto turned = [&](double gap) {
    auto b = builder();
    b.model.gravity.setZero();
    b.add_fixed_box("wall", {1, 1, 0.004}, at(0, 0, -0.002 - 0.001 - gap));
    const BodyId blade = b.add_box("blade", {0.2, 0.02, 0.002}, 0.05, at(0, 0, 0));
    b.body(blade).w_WB = {0, 0, 600.0};
    b.add_joint("shaft", world::JointKind::kHinge, {}, blade, {0, 0, 0}, {0, 0, 1});
    Lab lab(b.model);
    lab.run_ticks(100);
    EXPECT_EQ(lab.warned_ticks, 0);
    return lab.joint("shaft").position;
  };
  EXPECT_EQ(turned(0.002), turned(1.0));
}

// A ball that bounces between two plates, more often in a tick than it may have parts. It stays between them,
// and the ticks warn.
TEST_P(FastLinkedBodies, MoreHitsThanPartsAreToldAndHold) {
  auto b = shot(kAtPlateM - 0.004, 1.0);
  b.add_fixed_box("other", {kSheetM, 2, 2}, at(2.0 * kAtPlateM - 0.008, 0, 0), {1});
  Lab lab(b.model);
  for (int i = 0; i < 30; ++i) {
    lab.run_ticks(1);
    ASSERT_LT(lab.body("ball").p_WC.x(), 0.0) << i;
    ASSERT_GT(lab.body("ball").p_WC.x(), 2.0 * kAtPlateM - 0.008) << i;
  }
  EXPECT_GT(lab.warned_ticks, 0);
}

}  // namespace
}  // namespace visum::dynamics::testing
