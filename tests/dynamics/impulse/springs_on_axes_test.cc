// A spring about a hinge's own axis, or along a slider's, is a law of that axis in the tree. It must do what
// the same spring does as a row: one whose axis is off by a hair is one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"

namespace visum::dynamics::impulse {
namespace {

using Eigen::Vector3d;
using testing::at;
using testing::Lab;
using testing::ModelBuilder;
using world::JointKind;

constexpr double kHair = 1e-7;  // rad or m: far more than a spring on an axis may be off

struct Sprung {
  double damping = 0.0;         // of the joint, beside the spring's
  double spring_damping = 0.0;  // N·m·s/rad, N·s/m
  double rest = 0.4;            // rad; of sliders m beyond the start
  bool backwards = false;       // the spring's axis is turned around
  bool hits = false;            // the tip falls onto the ground and bounces
  bool limited = false;         // the joints have stops that they meet
  double friction = 0.0;        // dry, of the joint: the spring is a row then in either model
};

// Two links with hinges about y, the first one on the world, then a slider along the second link's axis x. A
// spring acts in each of the three.
world::WorldModel sprung_arm(const Sprung& with, double off, int order = 2) {
  ModelBuilder b(physics::engine_row(order == 4 ? "impulse-order4" : "impulse").setting);
  b.model.tick_ns = 1'000'000;
  if (with.hits) b.add_ground(b.add_surface(0.5, 0.5));
  const auto upper = b.add_box("upper", {0.5, 0.05, 0.05}, 2.0, at(0.25, 0.0, 1.0));
  const auto lower = b.add_box("lower", {0.5, 0.05, 0.05}, 1.0, at(0.75, 0.0, 1.0));
  const auto tip = b.add_sphere("tip", 0.05, 0.3, at(1.1, 0.0, 1.0));
  const std::vector<std::tuple<std::string, JointKind, world::BodyId, world::BodyId, Vector3d, Vector3d>>
      joints{{"shoulder", JointKind::kHinge, {}, upper, {0.0, 0.0, 1.0}, Vector3d::UnitY()},
             {"elbow", JointKind::kHinge, upper, lower, {0.5, 0.0, 1.0}, Vector3d::UnitY()},
             {"wrist", JointKind::kSlider, lower, tip, {1.1, 0.0, 1.0}, Vector3d::UnitX()}};
  for (const auto& [name, kind, parent, child, anchor, axis] : joints) {
    world::Joint& joint = b.add_joint(name, kind, parent, child, anchor, axis);
    joint.damping = with.damping;
    joint.friction = with.friction;
    joint.limited = with.limited;
    joint.lower = kind == JointKind::kHinge ? -0.3 : -0.05;
    joint.upper = kind == JointKind::kHinge ? 0.3 : 0.05;
  }
  for (const auto& [name, kind, parent, child, anchor, axis] : joints) {
    const bool turns = kind == JointKind::kHinge;
    const Vector3d tilted = ((with.backwards ? -1.0 : 1.0) * axis + off * Vector3d::UnitZ()).normalized();
    world::Joint& spring =
        b.add_joint(name + "_spring", turns ? JointKind::kTorsionSpring : JointKind::kSpring, parent, child,
                    anchor, turns ? tilted : axis);
    // A spring along the slider pulls at a point far behind it.
    if (!turns) spring.X_PJ.p -= Vector3d(0.3, off, 0.0);
    spring.stiffness = turns ? 20.0 : 400.0;
    spring.damping = with.spring_damping;
    spring.rest = turns ? with.rest : 0.3 + 0.1 * with.rest;
  }
  return b.model;
}

// Their positions (rad, m) and the efforts (N·m, N) of joints and springs, over a second. `act` may drive
// them.
void expect_the_same(const Sprung& with, const std::function<void(Lab&, int)>& act = {}, int order = 2) {
  Lab tree(sprung_arm(with, 0.0, order)), row(sprung_arm(with, kHair, order));
  std::uint64_t tree_work = 0, row_work = 0;
  double off = 0.0, effort_off = 0.0, moved = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    if (act) act(tree, tick);
    if (act) act(row, tick);
    const StepResult by_tree = tree.step(), by_row = row.step();
    ASSERT_TRUE(by_tree.ok && by_row.ok);
    tree_work += by_tree.work;
    row_work += by_row.work;
    for (std::size_t i = 0; i < tree.model.joints.size(); ++i) {
      const auto &one = tree.state.joints[i], &other = row.state.joints[i];
      off = std::max(off, std::abs(one.position - other.position));
      effort_off = std::max(effort_off, std::abs(one.effort - other.effort));
      moved = std::max(moved, std::abs(one.velocity));
    }
  }
  EXPECT_GT(moved, 1.0);
  EXPECT_LT(off, 1e-6);
  EXPECT_LT(effort_off, 1e-4);
  // Rows take more work, so the springs were laws where they could be.
  if (with.friction == 0.0) {
    EXPECT_LT(tree_work, row_work * 4 / 5);
  }
}

TEST(SpringsOnAxes, SwingAsRowsDo) {
  for (const bool backwards : {false, true}) {
    expect_the_same({.backwards = backwards});
    expect_the_same({.rest = -0.5, .backwards = backwards});
  }
}

TEST(SpringsOnAxes, SwingAsRowsDoWithOrderFour) {
  expect_the_same({}, {}, 4);
}

TEST(SpringsOnAxes, AreDampedAsRowsAre) {
  expect_the_same({.spring_damping = 0.1});
  expect_the_same({.damping = 0.1});
  expect_the_same({.damping = 0.1, .spring_damping = 0.1, .backwards = true});
}

TEST(SpringsOnAxes, MeetStopsAndTheGroundAsRowsDo) {
  expect_the_same({.damping = 0.05, .hits = true});
  expect_the_same({.damping = 0.05, .limited = true});
}

TEST(SpringsOnAxes, AreRowsWhereFrictionActs) {
  expect_the_same({.friction = 0.2});
}

// A motor that gives a torque alone leaves the spring in the tree; a servo takes its axis.
TEST(SpringsOnAxes, ComeAndGoWithTheDrives) {
  expect_the_same({.damping = 0.1}, [](Lab& lab, int tick) {
    lab.drive("shoulder").feedforward = tick < 300 ? -8.0 : 0.0;
    lab.drive("elbow") =
        tick / 200 % 2 == 1 ? hwparts::JointDrive{-2.0, 0.05, 30.0, 1.0} : hwparts::JointDrive{};
  });
}

TEST(SpringsOnAxes, GoOnWithTheSameBitsFromARestoredState) {
  const world::WorldModel model = sprung_arm({.damping = 0.05, .hits = true}, 0.0);
  Lab straight(model), fresh(model);
  straight.run_ticks(450);
  fresh.state = straight.state;
  straight.run_ticks(300);
  fresh.run_ticks(300);
  EXPECT_EQ(straight.hash(), fresh.hash());
}

// A wheel whose spring is wound up by two turns and a half. An axle that begins at more than a turn, where
// the spring does not count the turn, changes nothing.
TEST(SpringsOnAxes, CountWholeTurns) {
  constexpr double kInertia = 0.1, kStiffness = 3.0, kWound = 5.0 * std::numbers::pi, kStart = 0.5;
  for (const double turns : {0.0, 1.0, -2.0}) {
    ModelBuilder b(physics::engine_row("impulse").setting);
    const auto wheel = b.add_rotor("wheel", 1.0, kInertia, at(0.0, 0.0, 0.0));
    b.add_joint("axle", JointKind::kHinge, {}, wheel, Vector3d::Zero(), Vector3d::UnitY()).initial_position =
        kStart + 2.0 * std::numbers::pi * turns;
    world::Joint& spring =
        b.add_joint("spring", JointKind::kTorsionSpring, {}, wheel, Vector3d::Zero(), Vector3d::UnitY());
    spring.stiffness = kStiffness;
    spring.rest = kWound;
    Lab lab(b.model);
    double off = 0.0;
    for (int tick = 1; tick <= 2000; ++tick) {
      lab.run_ticks(1);
      const double t = lab.tick_s() * tick;
      off = std::max(off, std::abs(lab.joint("spring").position - kWound -
                                   (kStart - kWound) * std::cos(std::sqrt(kStiffness / kInertia) * t)));
    }
    EXPECT_LT(off, 5e-4) << turns;
  }
}

struct Passing {
  double rest, speed;  // m, m/s
  double energy;       // J, by which it may change at most
};

// A block on a rail whose spring it passes by both ways. Returns the largest change of its energy, J, and how
// often it has passed.
std::pair<double, int> pass_through_no_length(double rest, double speed) {
  constexpr double kMass = 2.0, kStiffness = 50.0, kStart = 0.2;
  ModelBuilder b(physics::engine_row("impulse").setting);
  b.model.gravity.setZero();
  const auto block = b.add_box("block", {0.1, 0.1, 0.1}, kMass, at(kStart, 0.0, 0.0));
  b.body(block).v_WB.x() = speed;
  b.add_joint("rail", JointKind::kSlider, {}, block, Vector3d::Zero(), Vector3d::UnitX());
  world::Joint& spring =
      b.add_joint("spring", JointKind::kSpring, {}, block, {kStart, 0.0, 0.0}, Vector3d::UnitX());
  spring.X_PJ.p.setZero();
  spring.stiffness = kStiffness;
  spring.rest = rest;
  Lab lab(b.model);
  const auto energy = [&] {
    const auto& now = lab.body("block");
    const double stretch = std::abs(now.p_WC.x()) - rest;
    return 0.5 * (kMass * now.v_WC.squaredNorm() + kStiffness * stretch * stretch);
  };
  const double start = energy();
  double changed = 0.0;
  int passed = 0;
  for (int tick = 0; tick < 8000; ++tick) {
    const double before = lab.body("block").p_WC.x();
    lab.run_ticks(1);
    passed += before * lab.body("block").p_WC.x() < 0.0;
    changed = std::max(changed, std::abs(energy() - start));
  }
  return {changed, passed};
}

// The force of a spring with a length of its own turns around there, within a tick: up to v h k rest is won
// or lost each time, which must not add up.
TEST(SpringsOnAxes, KeepTheirEnergyThroughNoLength) {
  for (const auto& [rest, speed, most] :
       {Passing{0.0, 0.0, 1e-4}, Passing{0.1, -3.0, 0.05}, Passing{0.5, -6.0, 0.5}}) {
    const auto [changed, passed] = pass_through_no_length(rest, speed);
    EXPECT_GT(passed, 10) << rest;
    EXPECT_LT(changed, most) << rest;
  }
}

// They are next to nothing, and as laws would give way without limit.
TEST(SpringsOnAxes, MayBeSofterThanAnything) {
  for (const double stiffness : {1e-6, 1e-12, 1e-40, 1e-303}) {
    ModelBuilder b(physics::engine_row("impulse").setting);
    const auto arm = b.add_box("arm", {0.5, 0.05, 0.05}, 1.0, at(0.25, 0.0, 0.0));
    b.add_joint("hinge", JointKind::kHinge, {}, arm, Vector3d::Zero(), Vector3d::UnitY());
    b.add_joint("spring", JointKind::kTorsionSpring, {}, arm, Vector3d::Zero(), Vector3d::UnitY()).stiffness =
        stiffness;
    Lab lab(b.model);
    lab.run_ticks(200);
    EXPECT_EQ(lab.warned_ticks, 0) << stiffness;
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
