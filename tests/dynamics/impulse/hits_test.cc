// A hit bounces once: by Poisson's law as by Newton's, and off a stop whatever else acts on the joint.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/model_builder.h"
#include "tests/dynamics/physics/engine_rows.h"

namespace visum::dynamics::impulse {
namespace {

using dynamics::testing::at;
using dynamics::testing::Lab;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;

constexpr double kRadius = 0.05, kHeight = 0.5;  // m

double apex_after_a_bounce(const std::string& impact, double restitution) {
  auto setting = physics::engine_row("impulse").setting;
  setting.impact = impact;
  ModelBuilder b(setting);
  const auto surface = b.add_surface(0.5, restitution);
  b.add_ground(surface);
  b.add_sphere("ball", kRadius, 1.0, at(0.0, 0.0, kRadius + kHeight), surface);
  Lab lab(b.model);
  while (lab.body("ball").v_WC.z() <= 0.0 && lab.state.tick < 2000) EXPECT_TRUE(lab.step().ok);
  double apex = 0.0;
  for (int tick = 0; tick < 700 && lab.body("ball").v_WC.z() > 0.0; ++tick) {
    EXPECT_TRUE(lab.step().ok);
    apex = std::max(apex, lab.body("ball").p_WC.z() - kRadius);
  }
  return apex;
}

TEST(Hits, BothLawsOfRestitutionGiveTheSameBounceOfABall) {
  for (const double e : {0.3, 0.5, 0.8, 1.0})
    for (const char* impact : {"newton", "poisson"})
      EXPECT_NEAR(apex_after_a_bounce(impact, e), e * e * kHeight, 2e-4) << impact << ", " << e;
}

// The slider's speed after it has met its stop.
double speed_after_a_stop(double friction_n, const hwparts::JointDrive& drive) {
  ModelBuilder b(physics::engine_row("impulse").setting);
  b.model.gravity.setZero();
  const auto body = b.add_rotor("body", 1.0, 1e-2, at(0.0, 0.0, 0.0));
  b.body(body).v_WB = {1.0, 0.0, 0.0};
  world::Joint& slider =
      b.add_joint("slider", world::JointKind::kSlider, {}, body, Vector3d::Zero(), Vector3d::UnitX());
  slider.limited = true;
  slider.lower = -1.0;
  slider.upper = 0.1;
  slider.stop_restitution = 0.6;
  slider.friction = friction_n;
  Lab lab(b.model);
  double slowest = 1.0;
  for (int tick = 0; tick < 120; ++tick) {
    lab.drives[0] = drive;
    EXPECT_TRUE(lab.step().ok);
    slowest = std::min(slowest, lab.joint("slider").velocity);
  }
  return slowest;
}

// A ball of 1 kg at 1 m/s meets a rod that hangs on a hinge: their kinetic energy before was 0.5 J.
struct Struck {
  explicit Struck(double friction, const hwparts::JointDrive& drive, double restitution) {
    ModelBuilder b(physics::engine_row("impulse").setting);
    b.model.gravity.setZero();
    const auto surface = b.add_surface(0.0, restitution);
    const auto rod = b.add_box("rod", {0.02, 0.02, 1.0}, 0.1, at(0.0, 0.0, 0.0), surface);
    b.body(b.add_sphere("ball", kRadius, 1.0, at(-0.2, 0.0, -0.4), surface)).v_WB = {1.0, 0.0, 0.0};
    b.add_joint("hinge", world::JointKind::kHinge, {}, rod, {0.0, 0.0, 0.5}, Vector3d::UnitY()).friction =
        friction;
    Lab lab(b.model);
    lab.drives[0] = drive;
    lab.run(0.2);
    ball = lab.body("ball").v_WC.x();
    rod_speed = std::abs(lab.joint("hinge").velocity);
    energy = lab.kinetic_energy();
  }
  double ball, rod_speed, energy;
};

TEST(Hits, WhatIsHeldByLittleIsThrownAsIfItWereFree) {
  const hwparts::JointDrive none{}, weak{0.0, 1e-3, 1e-3, 0.0};
  for (const double restitution : {0.5, 1.0}) {
    const Struck free(0.0, none, restitution);
    EXPECT_GT(free.ball, 0.8);
    for (const Struck& held : {Struck(1e-3, none, restitution), Struck(0.0, weak, restitution)}) {
      EXPECT_NEAR(held.ball, free.ball, 1e-3);
      EXPECT_NEAR(held.rod_speed, free.rod_speed, 0.02);
      EXPECT_LE(held.energy, 0.5);
    }
  }
}

TEST(Hits, WhatIsHeldFastThrowsBack) {
  const Struck braked(1e5, {}, 1.0);
  EXPECT_NEAR(braked.ball, -1.0, 1e-3);
  EXPECT_NEAR(braked.rod_speed, 0.0, 1e-6);
}

TEST(Hits, WhatIsHitHarderThanItIsHeldGivesWayAndWinsNoEnergy) {
  for (const double friction : {0.1, 1.0, 10.0, 100.0, 300.0}) {
    const Struck held(friction, {}, 1.0);
    EXPECT_LE(held.energy, 0.5 + 1e-9) << friction;
  }
}

TEST(Hits, AStopThrowsBackWhatFrictionOrADriveHolds) {
  EXPECT_NEAR(speed_after_a_stop(0.0, {}), -0.6, 1e-3);
  EXPECT_NEAR(speed_after_a_stop(0.1, {}), -0.6, 0.02) << "dry friction";
  EXPECT_NEAR(speed_after_a_stop(0.0, {0.0, 0.01, 0.5, 0.0}), -0.6, 0.05)
      << "a weak drive that wants to stand";
}

}  // namespace
}  // namespace visum::dynamics::impulse
