// Laws of drives and dry friction that reach their limits and leave them, all along one arm. hwparts/joint.h
// holds in every tick, whether the law took part in the tree, as a known impulse, or as a row.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/measures.h"
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

// To and fro, each axis at its own pace. Every other axis pushes to one side only, as a flank of a gear does.
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

// With a bob on a spring far away, or the bob alone.
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

// With two rods that swing far away, or the rods alone.
world::WorldModel with_rods(bool beside_the_arm) {
  using dynamics::testing::at;
  dynamics::testing::ModelBuilder b(physics::engine_row("impulse").setting);
  const auto first = b.add_rotor("first", 1.0, 0.1, at(5.5, 0.0, 0.0));
  const auto second = b.add_rotor("second", 1.0, 0.1, at(6.5, 0.0, 0.0));
  b.add_joint("upper", world::JointKind::kHinge, {}, first, {5.0, 0.0, 0.0}, Eigen::Vector3d::UnitY());
  b.add_joint("lower", world::JointKind::kHinge, first, second, {6.0, 0.0, 0.0}, Eigen::Vector3d::UnitY());
  if (!beside_the_arm) return b.model;
  world::WorldModel model = arm();
  const auto bodies = static_cast<std::int32_t>(model.bodies.size());
  model.bodies.insert(model.bodies.end(), b.model.bodies.begin(), b.model.bodies.end());
  for (world::Joint joint : b.model.joints) {
    if (joint.parent.valid()) joint.parent.value += bodies;
    joint.child.value += bodies;
    model.joints.push_back(joint);
  }
  return model;
}

TEST(LawLimits, LawsThatChangeSidesTakeNothingFromWhatIsForeseen) {
  dynamics::testing::Lab alone(with_rods(false)), beside(with_rods(true));
  for (int tick = 0; tick < 2000; ++tick) {
    ASSERT_TRUE(alone.step().ok);
    step(beside);
    ASSERT_EQ(alone.body("second").p_WC, beside.body("second").p_WC) << "tick " << tick;
  }
}

// A crank that turns freely pushes a piston with friction through a rod. In the ticks in which the piston
// turns back its friction cannot hold it: the crank moves it on.
dynamics::testing::Lab slider_crank(double friction, double tick_s, double speed) {
  using dynamics::testing::at;
  dynamics::testing::ModelBuilder b(physics::engine_row("impulse").setting);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  b.model.gravity.setZero();
  const auto crank = b.add_rotor("crank", 2.0, 0.5, at(0.0, 0.1, 0.0));
  const auto rod = b.add_rotor("rod", 0.5, 0.01, at(0.3, 0.1, 0.0));
  const auto piston = b.add_rotor("piston", 0.5, 0.01, at(0.6, 0.0, 0.0));
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ(), pin{0.0, 0.2, 0.0}, wrist{0.6, 0.0, 0.0};
  b.add_joint("main", world::JointKind::kHinge, {}, crank, Eigen::Vector3d::Zero(), z);
  b.add_joint("pin", world::JointKind::kHinge, crank, rod, pin, z);
  b.add_joint("slide", world::JointKind::kSlider, {}, piston, wrist, Eigen::Vector3d::UnitX()).friction =
      friction;
  b.add_joint("wrist", world::JointKind::kHinge, piston, rod, wrist, z);
  b.body(crank).w_WB = speed * z;
  b.body(crank).v_WB = {-0.1 * speed, 0.0, 0.0};
  b.body(rod).v_WB = b.body(piston).v_WB = {-0.2 * speed, 0.0, 0.0};
  return dynamics::testing::Lab(b.model);
}

TEST(LawLimits, APistonWithFrictionPassesItsDeadCentres) {
  for (const double friction : {0.01, 1.0})
    for (const double tick_s : {1e-3, 1e-2})
      for (int i = 0; i < 10; ++i) {
        auto lab = slider_crank(friction, tick_s, 5.0 + 0.2 * i);
        const double turns = lab.joint("main").position;
        const double energy = lab.kinetic_energy();
        for (int tick = 0; tick < std::lround(1.0 / tick_s); ++tick) {
          const dynamics::StepResult result = lab.step();
          ASSERT_TRUE(result.ok) << result.fault << ", friction " << friction << ", tick " << tick;
          ASSERT_LE(std::abs(lab.joint("slide").effort), friction * (1.0 + 1e-9));
        }
        EXPECT_GT(lab.joint("main").position, turns + 4.0);
        EXPECT_LT(lab.kinetic_energy(), energy);
        EXPECT_EQ(lab.warned_ticks, 0);
        EXPECT_LT(physics::max_gap(lab.model, lab.state), 2e-9);
      }
}

// Two bodies that tumble; two joints together hold them completely.
dynamics::testing::ModelBuilder held_twice(const char* solver, world::JointKind second) {
  using dynamics::testing::at;
  world::EngineSetting setting = physics::engine_row("impulse").setting;
  setting.solver = solver;
  dynamics::testing::ModelBuilder b(setting);
  b.model.gravity.setZero();
  const auto base = b.add_rotor("base", 2.0, 0.1, at(0.0, 0.0, 0.0));
  const auto door = b.add_rotor("door", 1.0, 0.05, at(0.1, 0.2, 0.1, 0.3, {1, 2, 3}));
  b.add_joint("screw", world::JointKind::kScrew, base, door, {0.05, 0.1, 0.0}, {0.6, 0.8, 0.0}).pitch_m = 0.1;
  b.add_joint("bolt", second, base, door, {0.2, 0.2, 0.3}, {0.0, 0.8, 0.6});
  const Eigen::Vector3d turn(3.0, -4.0, 2.0);
  for (const auto body : {base, door}) {
    b.body(body).w_WB = turn;
    b.body(body).v_WB = turn.cross(b.body(body).X_WB.p);
  }
  return b;
}

TEST(LawLimits, FrictionInWhatIsHeldTwiceHoldsNothingUp) {
  for (const auto second : {world::JointKind::kHinge, world::JointKind::kSlider, world::JointKind::kScrew}) {
    auto b = held_twice("direct", second);
    b.model.joints[0].friction = 3.0;
    dynamics::testing::Lab lab(b.model);
    for (int tick = 0; tick < 200; ++tick) {
      const dynamics::StepResult result = lab.step();
      ASSERT_TRUE(result.ok) << result.fault << ", tick " << tick;
    }
    EXPECT_EQ(lab.warned_ticks, 0);
    EXPECT_LT(physics::max_gap(lab.model, lab.state), 1e-9);
  }
}

// Nothing can move it, so the effort that it would need is not defined.
TEST(LawLimits, AStopOfWhatIsHeldTwiceGivesNothing) {
  for (const char* solver : {"direct", "iterate"})
    for (const auto second :
         {world::JointKind::kPointOnPlane, world::JointKind::kHinge, world::JointKind::kFixed}) {
      auto b = held_twice(solver, second);
      world::Joint& joint = b.model.joints[0];
      joint.limited = true;
      joint.stop_restitution = 0.5;
      joint.upper = 1.0;
      dynamics::testing::Lab lab(b.model);
      physics::MomentumDrift drift(lab.model, lab.state);
      for (int tick = 0; tick < 500; ++tick) {
        ASSERT_TRUE(lab.step().ok);
        drift.look(lab.model, lab.state);
      }
      EXPECT_LT(drift.linear, 1e-12) << solver;
      EXPECT_LT(drift.angular, 1e-12) << solver;
    }
}

TEST(LawLimits, ADriveOfWhatIsHeldTwiceGivesAllThatItMay) {
  for (const auto second : {world::JointKind::kHinge, world::JointKind::kSlider, world::JointKind::kScrew})
    for (const char* driven : {"screw", "bolt"}) {
      dynamics::testing::Lab lab(held_twice("direct", second).model);
      for (int tick = 0; tick < 100; ++tick) {
        const double sign = tick % 7 < 3 ? -1.0 : 1.0;
        lab.drive(driven) = {2.0 * sign, 0.0, kMost, 0.0};
        ASSERT_TRUE(lab.step().ok);
        ASSERT_NEAR(lab.joint(driven).effort, sign * kMost, 1e-9) << driven << ", tick " << tick;
      }
    }
}

// The law holds for the turn of a screw, whatever it lifts.
TEST(LawLimits, TheLawHoldsForAScrew) {
  auto b = held_twice("direct", world::JointKind::kBall);
  b.model.joints.pop_back();
  b.model.tick_ns = 10'000'000;
  b.body({0}).inertia_C.diagonal() = Eigen::Vector3d(0.1, 0.15, 0.2);
  dynamics::testing::Lab lab(b.model);
  lab.drive("screw") = {1.0, 0.5, 100.0, 0.0};
  for (int tick = 0; tick < 200; ++tick) {
    ASSERT_TRUE(lab.step().ok);
    const world::JointState& joint = lab.joint("screw");
    ASSERT_NEAR(joint.effort, (1.0 - joint.velocity) / 0.5, 1e-9) << tick;
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
