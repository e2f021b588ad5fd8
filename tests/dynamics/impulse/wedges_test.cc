// Links of one arm that hold each other by their shapes: no motion that the joints allow opens all of their
// contacts, and friction holds some of them shut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::dynamics::impulse {
namespace {

using Eigen::Vector3d;
using testing::at;
using testing::BodyId;
using testing::Lab;
using testing::ModelBuilder;
using world::JointKind;

// Links rub against each other.
ModelBuilder rubbing(double tick_s) {
  ModelBuilder b(physics::engine_row("impulse").setting);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  b.add_surface(0.8, 0.0);
  return b;
}

// Numbers between -1 and 1, the same on every machine.
class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : state_(12345u + 7919u * seed) {}
  double next() {
    state_ = state_ * 1664525u + 1013904223u;
    return (state_ >> 8) / 8388608.0 - 1.0;
  }
  Vector3d direction() {
    Vector3d found = Vector3d::Zero();
    while (found.norm() < 0.2) {
      found.x() = next();
      found.y() = next();
      found.z() = next();
    }
    return found.normalized();
  }

 private:
  std::uint32_t state_;
};

// A hanging arm of six links, its joints as those of a common robot, with stops at two turns. Its links are
// rough stones that nearly touch, so that it falls into itself. `number` tells one set of stones from others.
world::WorldModel rough_arm(std::uint32_t number) {
  ModelBuilder b = rubbing(1e-3);
  Numbers numbers(number);
  const auto stone = [&](const std::string& name, const Vector3d& size, double mass_kg, const Vector3d& p) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 24; ++i) points.push_back(size.cwiseProduct(numbers.direction()));
    return b.add_hull(name, points, mass_kg, at(p.x(), p.y(), p.z()));
  };
  const BodyId base = stone("base", {0.075, 0.075, 0.06}, 4.0, {0.0, 0.0, -0.04});
  b.add_joint("foot", JointKind::kFixed, {}, base, {0.0, 0.0, -0.04}, Vector3d::UnitZ());
  const BodyId shoulder = b.add_rotor("shoulder", 2.0, 0.01, at(0.0, 0.0, 0.02));
  const BodyId upper = stone("upper", {0.16, 0.05, 0.06}, 3.4, {0.12, 0.10, 0.03});
  const BodyId lower = stone("lower", {0.14, 0.045, 0.045}, 1.3, {0.36, 0.02, 0.03});
  const BodyId wrist = stone("wrist", {0.05, 0.06, 0.05}, 1.0, {0.48, 0.09, 0.03});
  const BodyId tool = stone("tool", {0.05, 0.05, 0.06}, 1.0, {0.48, 0.09, -0.05});
  const auto hinge = [&](const std::string& name, BodyId parent, BodyId child, const Vector3d& anchor,
                         const Vector3d& axis) {
    world::Joint& joint = b.add_joint(name, JointKind::kHinge, parent, child, anchor, axis);
    joint.limited = true;
    joint.lower = -6.28;
    joint.upper = 6.28;
  };
  hinge("pan", {}, shoulder, Vector3d::Zero(), Vector3d::UnitZ());
  hinge("lift", shoulder, upper, {0.0, 0.06, 0.03}, Vector3d::UnitY());
  hinge("elbow", upper, lower, {0.24, 0.06, 0.03}, Vector3d::UnitY());
  hinge("bend", lower, wrist, {0.47, 0.05, 0.03}, Vector3d::UnitY());
  hinge("turn", wrist, tool, {0.48, 0.09, 0.0}, Vector3d::UnitZ());
  return b.model;
}

struct Course {
  double most_gain_j = 0.0, most_force_n = 0.0;
  int warned_ticks = 0;
};

// Three seconds of falling and swinging.
Course let_fall(std::uint32_t number) {
  Lab lab(rough_arm(number));
  Course course;
  double before = physics::energy_of(lab.model, lab.state);
  for (int tick = 0; tick < 3000; ++tick) {
    lab.run_ticks(1);
    const double now = physics::energy_of(lab.model, lab.state);
    course.most_gain_j = std::max(course.most_gain_j, now - before);
    before = now;
    for (const collision::Contact& contact : lab.contacts)
      course.most_force_n = std::max(course.most_force_n, contact.normal_force_n);
  }
  course.warned_ticks = lab.warned_ticks;
  return course;
}

// Contacts that wedged these pressed with up to 4e12 N once, and up to 2790 of the ticks fell short.
TEST(Wedges, DoNotPressWithoutLimit) {
  for (const std::uint32_t number : {20u, 34u, 119u, 131u, 139u, 191u, 220u, 238u, 244u}) {
    const Course course = let_fall(number);
    EXPECT_LT(course.most_force_n, 1e8) << number;
    EXPECT_LT(course.warned_ticks, 60) << number;
  }
}

// These gained between 4 and 52 kJ in one tick once. The whole arm swings with some 20 J.
TEST(Wedges, GainNoEnergy) {
  for (const std::uint32_t number : {15u, 44u, 155u, 177u, 196u, 199u, 243u, 250u, 253u, 278u, 298u})
    EXPECT_LT(let_fall(number).most_gain_j, 0.6) << number;
}

// A finger of 0.2 kg on a rail, between two walls that are 0.2 mm too near to each other. They cannot be
// parted, and must not press as if they could.
TEST(Wedges, ASlotThatIsTooNarrowPressesAsAStiffSpring) {
  constexpr double kTooDeep = 1e-4;
  ModelBuilder b = rubbing(1e-3);
  const BodyId finger = b.add_box("finger", {0.1, 0.02, 0.02}, 0.2, at(0.0, 0.0, 0.0));
  for (const double side : {-1.0, 1.0})
    b.add_fixed_box(side < 0.0 ? "left" : "right", {0.3, 0.1, 0.3}, at(0.0, side * (0.06 - kTooDeep), 0.0));
  b.add_joint("rail", JointKind::kSlider, {}, finger, Vector3d::Zero(), Vector3d::UnitY());
  Lab lab(b.model);
  lab.run(0.5);
  for (const char* wall : {"left", "right"}) {
    EXPECT_GT(lab.normal_force_between("finger", wall), 100.0);
    EXPECT_LT(lab.normal_force_between("finger", wall), 1000.0);
  }
  EXPECT_LT(lab.body("finger").p_WC.norm(), 1e-6);
  EXPECT_LT(lab.kinetic_energy(), 1e-12);
}

// Nothing is wedged where a light link on a rail carries 10,000 times its mass.
TEST(Wedges, AHeavyLoadOnALightPlateIsNone) {
  for (const double tick_s : {1e-3, 1e-2}) {
    ModelBuilder b = rubbing(tick_s);
    b.add_ground();
    const BodyId plate = b.add_box("plate", {0.2, 0.2, 0.02}, 0.01, at(0.0, 0.0, 0.01));
    b.add_joint("rail", JointKind::kSlider, {}, plate, {0.0, 0.0, 0.01}, Vector3d::UnitZ());
    b.add_box("load", {0.1, 0.1, 0.1}, 100.0, at(0.0, 0.0, 0.07));
    Lab lab(b.model);
    lab.run(2.0);
    EXPECT_NEAR(lab.body("load").p_WC.z(), 0.07, 2e-4) << tick_s;
  }
}

// Nor where a trunk stands on a foot of a thousandth of its mass, whose hinge lets it tip.
TEST(Wedges, ALightFootUnderAHeavyTrunkIsNone) {
  for (const double tick_s : {1e-3, 5e-3}) {
    ModelBuilder b = rubbing(tick_s);
    b.add_ground();
    const BodyId foot = b.add_box("foot", {0.2, 0.08, 0.02}, 0.08, at(0.0, 0.0, 0.01));
    const BodyId trunk = b.add_box("trunk", {0.2, 0.2, 0.4}, 80.0, at(0.0, 0.0, 0.3));
    b.add_joint("guide", JointKind::kSlider, {}, trunk, {0.0, 0.0, 0.3}, Vector3d::UnitZ());
    b.add_joint("ankle", JointKind::kHinge, trunk, foot, {0.0, 0.0, 0.05}, Vector3d::UnitY());
    Lab lab(b.model);
    lab.run(2.0);
    EXPECT_NEAR(lab.body("trunk").p_WC.z(), 0.3, 3e-5) << tick_s;
  }
}

// A gripper closes on a box and stays shut. Its servos hold the fingers without a limit at first.
TEST(Wedges, FingersThatCloseOnAThingAreNone) {
  for (const double tick_s : {1e-3, 5e-3}) {
    ModelBuilder b = rubbing(tick_s);
    b.add_fixed_box("table", {1.0, 1.0, 0.1}, at(0.0, 0.0, -0.05));
    b.add_box("box", {0.06, 0.06, 0.06}, 0.02, at(0.0, 0.0, 0.03));
    for (const double side : {-1.0, 1.0}) {
      const std::string name = side < 0.0 ? "left" : "right";
      const Vector3d p(0.045 * side, 0.0, 0.05);
      const BodyId finger = b.add_box(name, {0.02, 0.04, 0.1}, 0.015, at(p.x(), p.y(), p.z() + 0.01));
      b.add_joint(name + "_rail", JointKind::kSlider, {}, finger, p, -side * Vector3d::UnitX());
    }
    Lab lab(b.model);
    for (const char* rail : {"left_rail", "right_rail"})
      lab.drive(rail) = hwparts::JointDrive{.target_velocity = 0.1, .max_effort = 140.0};
    double narrowest = 1.0;
    for (int tick = 0; tick < std::lround(1.0 / tick_s); ++tick) {
      lab.run_ticks(1);
      const double apart = lab.body("right").p_WC.x() - lab.body("left").p_WC.x() - 0.02;
      narrowest = std::min(narrowest, apart);
    }
    EXPECT_GT(narrowest, 0.059) << tick_s;
    EXPECT_NEAR(lab.normal_force_between("left", "box"), 140.0, 1.0) << tick_s;
  }
}

// A motor presses a ball on the axis of a turntable, which turns it by torsional friction alone. The table's
// point there stands still, but it does work: none of it may be taken for an error.
world::WorldModel ball_on_turntable() {
  ModelBuilder b = rubbing(1e-3);
  b.model.surfaces[0].torsional_friction = 0.05;
  const BodyId table = b.add_kinematic_box("table", {0.4, 0.4, 0.1}, at(0.0, 0.0, 0.05));
  b.body(table).w_WB = Vector3d(0.0, 0.0, 50.0);
  const BodyId quill = b.add_rotor("quill", 0.2, 1e-3, at(0.0, 0.0, 0.3));
  const BodyId ball = b.add_sphere("ball", 0.05, 0.5, at(0.0, 0.0, 0.15));
  b.body(ball).inertia_C *= 100.0;
  b.add_joint("press", JointKind::kSlider, {}, quill, {0.0, 0.0, 0.3}, -Vector3d::UnitZ());
  b.add_joint("spin", JointKind::kHinge, quill, ball, {0.0, 0.0, 0.15}, Vector3d::UnitZ());
  return b.model;
}

TEST(EnergyOfMechanisms, ATurntableMayTurnAPressedBall) {
  Lab lab(ball_on_turntable());
  lab.drive("press") = hwparts::JointDrive{.feedforward = 500.0};
  lab.run(0.12);
  EXPECT_NEAR(lab.body("ball").w_WB.z(), 50.0, 0.1);
  EXPECT_EQ(lab.warned_ticks, 0);
}

// Without gravity a robot is driven out of an overlap, and then rests or floats: no tick falls short.
TEST(EnergyOfMechanisms, BodiesThatOverlapPartWithoutGravity) {
  ModelBuilder b = rubbing(1e-3);
  b.model.gravity.setZero();
  b.add_fixed_box("floor", {2.0, 2.0, 0.2}, at(0.0, 0.0, -0.1));
  const BodyId trunk = b.add_box("trunk", {0.4, 0.2, 0.1}, 5.0, at(0.0, 0.0, 0.045));
  const BodyId arm = b.add_box("arm", {0.2, 0.05, 0.05}, 1.0, at(0.3, 0.0, 0.045));
  world::Joint& joint =
      b.add_joint("hinge", JointKind::kHinge, trunk, arm, {0.2, 0.0, 0.045}, Vector3d::UnitY());
  joint.limited = true;
  joint.lower = -1.0;
  joint.upper = 1.0;
  Lab lab(b.model);
  lab.run(0.3);
  EXPECT_GT(lab.body("trunk").p_WC.z(), 0.05 - 1e-6);
  EXPECT_EQ(lab.warned_ticks, 0);
}

}  // namespace
}  // namespace visum::dynamics::impulse
