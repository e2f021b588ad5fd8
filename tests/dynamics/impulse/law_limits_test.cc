// Laws of drives and dry friction that reach their limits and leave them, all along one arm: hwparts/joint.h
// holds in every tick, whether the law took part in the tree, as an impulse that is known, or as a row.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kMost = 4.0;        // N·m
constexpr double kFriction = 0.005;  // N·m, of the last joint, which no drive moves
constexpr std::size_t kDriven = 6;

world::WorldModel arm() {
  auto model = physics::arm7(physics::engine_row("impulse").setting, 1e-3);
  model.joints[kDriven].friction = kFriction;
  return model;
}

// To and fro, each axis at its own pace; every other one pushes to one side only, as a flank of a gear does.
void set_drives(dynamics::testing::Lab& lab) {
  const double time_s = static_cast<double>(lab.state.tick) * lab.tick_s();
  for (std::size_t i = 0; i < kDriven; ++i) {
    const double n = static_cast<double>(i);
    lab.drives[i] = {0.8 * std::sin((6.0 + n) * time_s + n), 0.02 + 0.01 * n, kMost,
                     i % 2 == 0 ? 0.0 : kMost};
  }
}

void step(dynamics::testing::Lab& lab) {
  set_drives(lab);
  ASSERT_TRUE(lab.step().ok);
}

TEST(LawLimits, TheLawHoldsWhereverItsLimitsAreReachedAndLeft) {
  dynamics::testing::Lab lab(arm());
  int at_limit = 0, within = 0, changes = 0;
  std::array<bool, kDriven> was_at_limit{};
  for (int tick = 0; tick < 2000; ++tick) {
    step(lab);
    for (std::size_t i = 0; i < kDriven; ++i) {
      const hwparts::JointDrive& drive = lab.drives[i];
      const world::JointState& joint = lab.state.joints[i];
      const double wanted = (drive.target_velocity - joint.velocity) / drive.compliance;
      const double given = std::clamp(wanted, -drive.max_effort, drive.max_effort);
      ASSERT_NEAR(joint.effort, given + drive.feedforward, 1e-6) << "joint " << i << ", tick " << tick;
      const bool limited = given != wanted;
      (limited ? at_limit : within) += 1;
      changes += limited != was_at_limit[i];
      was_at_limit[i] = limited;
    }
    const world::JointState& rubbing = lab.state.joints[kDriven];
    ASSERT_LE(std::abs(rubbing.effort), kFriction * (1.0 + 1e-9));
    if (std::abs(rubbing.velocity) > 1e-6) {
      ASSERT_NEAR(rubbing.effort, -std::copysign(kFriction, rubbing.velocity), 1e-9);
    }
  }
  EXPECT_GT(at_limit, 1000);
  EXPECT_GT(within, 1000);
  EXPECT_GT(changes, 50);
}

// With a bob on a spring far away, or that alone.
world::WorldModel with_bob(bool beside_the_arm) {
  world::WorldModel model = arm();
  if (!beside_the_arm) {
    model.bodies.clear();
    model.joints.clear();
    model.shapes.clear();
    model.no_collision.clear();
  }
  world::Body bob;
  bob.name = "bob";
  bob.mass_kg = 1.0;
  bob.inertia_C = 1e-2 * Eigen::Matrix3d::Identity();
  bob.X_WB.p = {5.4, 0.0, 0.0};
  world::Joint spring;
  spring.name = "spring";
  spring.kind = world::JointKind::kSpring;
  spring.child = {static_cast<std::int32_t>(model.bodies.size())};
  spring.X_PJ.p = {5.0, 0.0, 0.0};
  spring.stiffness = 300.0;
  spring.rest = 0.3;
  model.bodies.push_back(bob);
  model.joints.push_back(spring);
  return model;
}

TEST(LawLimits, LawsThatChangeSidesTakeNothingFromSprings) {
  dynamics::testing::Lab alone(with_bob(false)), beside(with_bob(true));
  for (int tick = 0; tick < 2000; ++tick) {
    ASSERT_TRUE(alone.step().ok);
    step(beside);
    ASSERT_EQ(alone.body("bob").p_WC, beside.body("bob").p_WC) << "tick " << tick;
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
