// The law of hwparts/joint.h, tick by tick, on a rotor and on a slide of known inertia.
#include <algorithm>

#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {
namespace {

using world::JointKind;
constexpr double kInertia = 0.25;        // kg·m², and kg of the slide
constexpr double kSoftnessOfOde = 1e-9;  // m/s or rad/s that ODE's least cfm lets through at about 1 N

// One tick of an inertia under a drive, in closed form: the unlimited term of the drive, and its limit.
struct ImplicitDrive {
  double inertia, tick_s;

  double next(double v, const hwparts::JointDrive& drive) const {
    const double free = v + tick_s / inertia * drive.feedforward;
    const double wanted =
        inertia / tick_s * (drive.target_velocity - free) / (1.0 + drive.compliance * inertia / tick_s);
    return free + tick_s / inertia * std::clamp(wanted, -drive.max_effort, drive.max_effort);
  }
};

struct Mechanism {
  friend void PrintTo(const Mechanism& mechanism, std::ostream* out) { *out << mechanism.name; }

  const char* name;
  JointKind kind;
  bool on_a_free_parent;
};

class DriveLaw : public ::testing::TestWithParam<std::tuple<Row, Mechanism>> {
 protected:
  const Row& row() const { return std::get<0>(GetParam()); }

  // The joint is askew, so that no axis is a coordinate axis.
  ModelBuilder builder() const {
    const Mechanism& mechanism = std::get<1>(GetParam());
    ModelBuilder b(row().engine);
    b.model.gravity.setZero();
    const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 3).normalized();
    BodyId parent;
    // A free parent with a billion times the inertia stands for the ground, so the code for two bodies is
    // tested as well.
    if (mechanism.on_a_free_parent)
      parent = b.add_rotor("base", 1e9 * kInertia, 1e9 * kInertia, at(0.3, 0.2, 0.1));
    const BodyId child = b.add_rotor("rotor", kInertia, kInertia, at(0.3, 0.2, 0.1, 0.5, {1, 1, 0}));
    b.add_joint("joint", mechanism.kind, parent, child, {0.3, 0.2, 0.1}, axis);
    return b;
  }

  void expect_law(Lab& lab, const hwparts::JointDrive& drive, int ticks) const {
    const ImplicitDrive exact{kInertia, lab.tick_s()};
    lab.drive("joint") = drive;
    const double scale =
        std::max({std::abs(drive.target_velocity), std::abs(lab.joint("joint").velocity), 1e-3});
    for (int i = 0; i < ticks; ++i) {
      const double before = lab.joint("joint").velocity;
      ASSERT_TRUE(lab.step().ok);
      const double after = lab.joint("joint").velocity;
      ASSERT_NEAR(after, exact.next(before, drive),
                  row().accuracy.drive_law * scale + 1e-7 * scale + kSoftnessOfOde)
          << "tick " << i;
      const double felt = kInertia * (after - before) / lab.tick_s();
      ASSERT_NEAR(lab.joint("joint").effort, felt, 1e-5 * std::max(1.0, std::abs(felt))) << "tick " << i;
    }
  }
};

INSTANTIATE_TEST_SUITE_P(
    Engines, DriveLaw,
    ::testing::Combine(::testing::ValuesIn(rows()),
                       ::testing::Values(Mechanism{"Hinge", JointKind::kHinge, false},
                                         Mechanism{"Slider", JointKind::kSlider, false},
                                         Mechanism{"HingeOnABody", JointKind::kHinge, true},
                                         Mechanism{"SliderOnABody", JointKind::kSlider, true})),
    [](const auto& info) { return std::get<0>(info.param).name + std::get<1>(info.param).name; });

TEST_P(DriveLaw, ASoftDriveApproachesItsTarget) {
  Lab lab(builder().model);
  expect_law(lab, {2.0, 0.5, 100.0, 0.0}, 200);
  EXPECT_GT(lab.joint("joint").velocity, 1.0);
}

TEST_P(DriveLaw, ARotorsComplianceOfTickByInertiaIsARotorInSeries) {
  // h / J_r: the velocity after one tick is that of two inertias that hit without bouncing.
  Lab lab(builder().model);
  const double rotor = 3.0 * kInertia;
  lab.drive("joint") = {1.0, lab.tick_s() / rotor, 1e6, 0.0};
  ASSERT_TRUE(lab.step().ok);
  EXPECT_NEAR(lab.joint("joint").velocity, 0.75, 0.75 * row().accuracy.drive_law + 1e-7);
}

TEST_P(DriveLaw, TheLimitCapsTheEffort) {
  Lab lab(builder().model);
  expect_law(lab, {100.0, 1e-3, 0.7, 0.0}, 100);
  EXPECT_NEAR(lab.joint("joint").effort, 0.7, 1e-6);
}

TEST_P(DriveLaw, ANegativeTargetPullsTheOtherWay) {
  Lab lab(builder().model);
  expect_law(lab, {-3.0, 1e-2, 2.0, 0.0}, 200);
  EXPECT_LT(lab.joint("joint").velocity, -1.0);
  EXPECT_LT(lab.joint("joint").position, -0.1);
}

TEST_P(DriveLaw, WithoutComplianceTheTargetIsReachedAtOnce) {
  Lab lab(builder().model);
  lab.drive("joint") = {0.5, 0.0, 1e4, 0.0};
  ASSERT_TRUE(lab.step().ok);
  EXPECT_NEAR(lab.joint("joint").velocity, 0.5, 0.5 * row().accuracy.drive_law + 1e-6);
}

TEST_P(DriveLaw, AFeedforwardIsAPureTorque) {
  Lab lab(builder().model);
  expect_law(lab, {5.0, 0.1, 0.0, -0.4}, 100);
  EXPECT_NEAR(lab.joint("joint").effort, -0.4, 1e-9);
}

TEST_P(DriveLaw, FeedforwardAndLimitedTermAdd) {
  Lab lab(builder().model);
  expect_law(lab, {1.0, 0.05, 0.3, -0.4}, 100);
}

TEST_P(DriveLaw, DryFrictionBrakesToAStandAndHolds) {
  auto b = builder();
  Lab lab(b.model);
  lab.drive("joint") = {1.0, 0.0, 1e4, 0.0};
  ASSERT_TRUE(lab.step().ok);
  expect_law(lab, {0.0, 0.0, 0.5, 0.0}, 600);
  EXPECT_NEAR(lab.joint("joint").velocity, 0.0, 1e-6);
  expect_law(lab, {0.0, 0.0, 0.5, 0.4}, 10);  // pushed with less than the friction
  EXPECT_NEAR(lab.joint("joint").velocity, 0.0, 1e-6);
}

// A servo without compliance knows its limit, also where nothing else could give way: a finger that presses
// on a wall, alone or at the end of an arm that other servos hold.
TEST_P(DriveLaw, AnIdealServoStopsAtAWall) {
  constexpr double kLimit = 20.0, kSpeed = 0.2;
  for (const bool on_arm : {false, true}) {
    for (const std::int64_t tick_ns : {1'000'000, 10'000'000}) {
      auto b = builder();
      b.model.tick_ns = tick_ns;
      b.model.gravity.setZero();
      b.add_fixed_box("wall", {0.1, 1, 1}, at(0.05, 0, 0));
      BodyId arm;
      if (on_arm) {
        arm = b.add_box("arm", {0.1, 0.02, 0.02}, 1.0, at(-0.2, 0, 0));
        b.add_joint("shoulder", world::JointKind::kSlider, {}, arm, {-0.2, 0, 0}, {0, 1, 0});
      }
      const BodyId finger = b.add_box("finger", {0.02, 0.02, 0.02}, 0.1, at(-0.03, 0, 0));
      b.add_joint("rail", world::JointKind::kSlider, arm, finger, {-0.03, 0, 0}, {1, 0, 0});
      Lab lab(b.model);
      const auto drive = [&](double speed) {
        lab.drive("rail") = {.target_velocity = speed, .compliance = 0.0, .max_effort = kLimit};
        if (on_arm) lab.drive("shoulder") = {.target_velocity = 0.0, .compliance = 0.0, .max_effort = 1000.0};
      };
      drive(kSpeed);
      for (int k = 0; k < 100; ++k) {
        lab.run(0.01);
        ASSERT_LT(lab.body("finger").p_WC.x(), -0.01 + 1.5e-3 * (1e-6 * static_cast<double>(tick_ns)))
            << on_arm << " " << k;
      }
      EXPECT_NEAR(lab.normal_force_between("finger", "wall"), kLimit, 1e-2 * kLimit) << on_arm;
      EXPECT_NEAR(lab.joint("rail").effort, kLimit, 1e-2 * kLimit) << on_arm;
      // ODE's direct solver may give up on one.
      EXPECT_LE(lab.warned_ticks, row().engine.name == "ode" ? 1 : 0) << on_arm;
      // It lets go at once.
      drive(-kSpeed);
      lab.run(0.1);
      EXPECT_NEAR(lab.body("finger").v_WC.x(), -kSpeed, 1e-3 * kSpeed) << on_arm;
    }
  }
}

// A drawer that dry friction holds, or a servo that is to stand, gives way to a kinematic body that pushes
// it.
TEST_P(DriveLaw, WhatAKinematicBodyPushesGivesWay) {
  for (const bool friction : {true, false}) {
    auto b = builder();
    b.model.gravity.setZero();
    const BodyId pusher = b.add_kinematic_box("pusher", {0.1, 0.1, 0.1}, at(-0.11, 0, 0));
    b.body(pusher).v_WB = {0.2, 0, 0};
    const BodyId drawer = b.add_box("drawer", {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0));
    auto& rail = b.add_joint("drawer", world::JointKind::kSlider, {}, drawer, {0, 0, 0}, {1, 0, 0});
    if (friction) rail.friction = 5.0;
    Lab lab(b.model);
    if (!friction) lab.drive("drawer") = {.target_velocity = 0.0, .compliance = 0.0, .max_effort = 5.0};
    lab.run(1.0);
    EXPECT_NEAR(lab.body("drawer").p_WC.x(), 0.19, 1e-3) << friction;
    EXPECT_NEAR(lab.normal_force_between("pusher", "drawer"), 5.0, 0.05) << friction;
  }
}

// Two fingers of ideal servos that close on nothing meet, and press.
TEST_P(DriveLaw, IdealFingersMeet) {
  auto b = builder();
  const BodyId hand = b.add_box("hand", {0.1, 0.1, 0.1}, 2.0, at(0, 0, 1));
  b.add_joint("lift", world::JointKind::kSlider, {}, hand, {0, 0, 1}, {0, 0, 1});
  const BodyId left = b.add_box("left", {0.02, 0.02, 0.05}, 0.1, at(-0.06, 0, 0.9));
  const BodyId right = b.add_box("right", {0.02, 0.02, 0.05}, 0.1, at(0.06, 0, 0.9));
  b.add_joint("close_left", world::JointKind::kSlider, hand, left, {-0.06, 0, 0.9}, {1, 0, 0});
  b.add_joint("close_right", world::JointKind::kSlider, hand, right, {0.06, 0, 0.9}, {-1, 0, 0});
  Lab lab(b.model);
  lab.drive("lift") = {.target_velocity = 0.1, .compliance = 0.0, .max_effort = 1000.0};
  for (const char* joint : {"close_left", "close_right"})
    lab.drive(joint) = {.target_velocity = 0.2, .compliance = 0.0, .max_effort = 30.0};
  lab.run(1.0);
  EXPECT_NEAR(lab.body("right").p_WC.x() - lab.body("left").p_WC.x(), 0.02, 1e-3);
  EXPECT_NEAR(lab.normal_force_between("left", "right"), 30.0, 0.3);
  EXPECT_NEAR(lab.joint("lift").position, 0.1, 1e-3);
}

}  // namespace
}  // namespace visum::dynamics::testing
