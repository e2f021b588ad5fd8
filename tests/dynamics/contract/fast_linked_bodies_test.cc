// Bodies that joints hold do not pass through others either, when they move by more than their own thickness
// within a tick: with any engine that may make a tick more than once.
#include <cmath>
#include <numbers>

#include "tests/dynamics/contract/scenes.h"

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

// A hit that is foreseen bounces in the next tick, with what is left of its speed then.
TEST_P(FastLinkedBodies, ABallOnARailBouncesNoFasterThanItsRestitutionSays) {
  for (int i = 0; i < 13; ++i) {
    Lab lab(shot(-1.0 - 0.01 * i, 0.5).model);
    lab.run_ticks(30);
    EXPECT_LE(-lab.body("ball").v_WC.x(), 0.51 * kSpeed) << i;
    EXPECT_LT(lab.body("ball").p_WC.x(), kAtPlateM + 1e-3) << i;
  }
}

TEST_P(FastLinkedBodies, TheForcesOfTheHitAddUpToItsImpulse) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    for (int i = 0; i < 8; ++i) {
      Lab lab(shot(-1.0 - 0.0163 * i, restitution).model);
      double impulse = 0.0;
      for (int k = 0; k < 30; ++k) {
        lab.run_ticks(1);
        impulse += lab.normal_force_between("ball", "plate") * lab.tick_s();
      }
      EXPECT_NEAR(impulse, kBallKg * (kSpeed - lab.body("ball").v_WC.x()), 0.01 * kBallKg * kSpeed)
          << restitution << " " << i;
    }
  }
}

// A finger that its drive brakes before a wall does not leave it faster than its restitution allows.
TEST_P(FastLinkedBodies, ABrakedFingerGainsNothing) {
  for (const double gap : {0.005, 0.01, 0.015, 0.02}) {
    auto b = builder();
    b.model.tick_ns = 10'000'000;
    b.model.gravity.setZero();
    const world::SurfaceId surface = b.add_surface(0.3, 0.8);
    b.add_fixed_box("wall", {0.004, 1, 1}, at(0, 0, 0), surface);
    const double start = -0.007 - gap;
    const BodyId finger = b.add_box("finger", {0.01, 0.02, 0.02}, 0.1, at(start, 0, 0), surface);
    b.body(finger).v_WB = {5.0, 0, 0};
    b.add_joint("rail", world::JointKind::kSlider, {}, finger, {start, 0, 0}, {1, 0, 0});
    Lab lab(b.model);
    lab.drive("rail") = {.target_velocity = 0.0, .compliance = 1e9, .max_effort = 1e-9, .feedforward = -47.0};
    lab.run_ticks(1);
    // At the wall it has what the brake has left, by the energy that it took.
    const double left = std::sqrt(std::max(0.0, 25.0 - 2.0 * 470.0 * gap));
    const double braked = 4.7;  // m/s in a tick, which goes on after the hit
    for (int k = 0; k < 2; ++k) {
      EXPECT_GT(lab.body("finger").v_WC.x(), -0.8 * left - braked * (k + 1) - 0.05) << gap << " " << k;
      lab.run_ticks(1);
    }
  }
}

// A ball on two crossed rails is turned aside by a slanting plate. A post that its way would have met behind
// the plate is not hit.
TEST_P(FastLinkedBodies, WhatIsBehindAPlateIsNotHit) {
  const auto flight = [&](bool post) {
    auto b = builder();
    b.model.gravity.setZero();
    const world::SurfaceId ice = b.add_surface(0.0, 0.0);
    b.add_fixed_box("plate", {0.01, 0.3, 0.3}, at(0, 0, 0, std::numbers::pi / 4, {0, 0, 1}), ice);
    if (post) b.add_fixed_box("post", {0.01, 0.004, 0.3}, at(0.05, 0, 0), ice);
    const BodyId cart = b.add_rotor("cart", 0.01, 1e-5, at(-0.04, 0, 0));
    const BodyId ball = b.add_sphere("ball", 0.01, 0.2, at(-0.04, 0, 0), ice);
    for (const BodyId id : {cart, ball}) b.body(id).v_WB = {kSpeed, 0, 0};
    b.add_joint("along", world::JointKind::kSlider, {}, cart, {-0.04, 0, 0}, {1, 0, 0});
    b.add_joint("across", world::JointKind::kSlider, cart, ball, {-0.04, 0, 0}, {0, 1, 0});
    Lab lab(b.model);
    lab.run_ticks(3);
    EXPECT_EQ(lab.normal_force_between("ball", "post"), 0.0);
    return lab.body("ball").v_WC;
  };
  const Eigen::Vector3d with = flight(true), without = flight(false);
  EXPECT_LT((with - without).norm(), 1e-6) << with.transpose() << " and " << without.transpose();
  EXPECT_GT(std::abs(with.y()), 30.0);
}

// A ball on a slanting rail meets a door on a hinge, on one side of the hinge or the other. The door turns
// the way in which it is hit, wherever the ball is when the tick begins.
TEST_P(FastLinkedBodies, ADoorTurnsAsItIsHit) {
  double near = 0.0;  // rad/s, if the ball is near when the tick begins
  for (const auto& [before, door_first] :
       {std::pair(0.01, true), std::pair(0.06, true), std::pair(0.06, false), std::pair(0.10, false)}) {
    auto b = builder();
    b.model.gravity.setZero();
    const Eigen::Vector3d along = Eigen::Vector3d(1, 1, 0).normalized();
    const double touch_y = 0.03;
    const Eigen::Vector3d start = Eigen::Vector3d(kAtPlateM, touch_y, 0) - before * along;
    const auto add_door = [&] {
      const BodyId door = b.add_box("door", {kSheetM, 0.4, 0.2}, 1.0, at(0, 0, 0));
      b.add_joint("hinge", world::JointKind::kHinge, {}, door, {0, 0, 0}, {0, 0, 1});
    };
    if (door_first) add_door();
    const BodyId ball = b.add_sphere("ball", kRadiusM, kBallKg, at(start.x(), start.y(), 0));
    b.body(ball).v_WB = kSpeed * along;
    b.add_joint("rail", world::JointKind::kSlider, {}, ball, start, along);
    if (!door_first) add_door();
    Lab lab(b.model);
    lab.run_ticks(2);
    const double w = lab.body("door").w_WB.z();
    if (near == 0.0) near = w;
    EXPECT_LT(w, -10.0) << before << " " << door_first;
    EXPECT_NEAR(w, near, -0.15 * near) << before << " " << door_first;
  }
}

// A slanting rod on two crossed rails hits a plate with friction. It gains no energy.
TEST_P(FastLinkedBodies, ARoughHitGainsNoEnergy) {
  for (const double friction : {0.3, 1.0, 2.0}) {
    for (int i = 0; i < 6; ++i) {
      auto b = builder();
      b.model.gravity.setZero();
      const world::SurfaceId rough = b.add_surface(friction, 1.0);
      b.add_fixed_box("plate", {0.01, 1, 1}, at(0, 0, 0), rough);
      const Pose start = at(-0.3 - 0.009 * i, 0, 0, 0.6, {0, 0, 1});
      const BodyId cart = b.add_rotor("cart", 0.01, 1e-5, at(start.p.x(), 0, 0));
      const BodyId rod = b.add_box("rod", {0.3, 0.02, 0.02}, 0.5, start, rough);
      for (const BodyId id : {cart, rod}) b.body(id).v_WB = {60.0, 0, 0};
      b.add_joint("rail", world::JointKind::kSlider, {}, cart, start.p, {1, 0, 0});
      b.add_joint("pivot", world::JointKind::kHinge, cart, rod, start.p, {0, 0, 1});
      Lab lab(b.model);
      lab.drive("rail") = {.target_velocity = 0.0, .compliance = 1e9, .max_effort = 1e-9, .feedforward = 0.0};
      const double energy = lab.kinetic_energy();
      lab.run_ticks(20);
      EXPECT_LT(lab.kinetic_energy(), 1.01 * energy) << friction << " " << i;
    }
  }
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

// A tray on a rail, with a box on it that nothing holds but friction. Up to the hit the box moves with the
// tray.
TEST_P(FastLinkedBodies, WhatIsCarriedComesAlongUpToTheHit) {
  auto b = builder();
  const BodyId tray = b.add_box("tray", {0.2, 0.2, 0.02}, 5.0, at(-0.5, 0, 0));
  const BodyId box = b.add_box("box", {0.05, 0.05, 0.05}, 0.1, at(-0.5, 0, 0.035));
  b.add_fixed_box("plate", {kSheetM, 2, 0.01}, at(0, 0, 0));
  for (const BodyId id : {tray, box}) b.body(id).v_WB = {60.0, 0, 0};
  b.add_joint("rail", world::JointKind::kSlider, {}, tray, {-0.5, 0, 0}, {1, 0, 0});
  Lab lab(b.model);
  int ticks = 0;
  while (lab.body("tray").p_WC.x() < -0.12 && ++ticks < 30) {
    EXPECT_NEAR(lab.body("box").p_WC.x(), lab.body("tray").p_WC.x(), 1e-3) << ticks;
    lab.run_ticks(1);
  }
  EXPECT_NEAR(lab.body("tray").p_WC.x(), -0.1 - 0.5 * kSheetM, 2e-3);
  EXPECT_NEAR(lab.body("box").p_WC.x(), -0.5 + 0.06 * ticks, 2e-3);
}

// A body that falls elsewhere does not notice, but for the order of a step with contacts.
TEST_P(FastLinkedBodies, OthersGoOnAsTheyWould) {
  const auto fall = [&](bool plate) {
    auto b = shot(plate ? -1.03 : -100.0);
    b.model.gravity = {0, 0, -9.81};
    b.add_sphere("other", 0.1, 1.0, at(0, 50, 0));
    Lab lab(b.model);
    lab.run_ticks(30);
    return lab.body("other").p_WC.z();
  };
  EXPECT_NEAR(fall(true), fall(false), 1e-12);
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

// Thin ones that are near when the tick begins, in coarse ticks.
TEST_P(FastLinkedBodies, ThinSheetsStopThinOnes) {
  for (const double tick_s : {1e-3, 1e-2}) {
    for (const double gap : {1e-4, 1e-3, 1e-2}) {
      for (const double speed : {30.0, 100.0}) {
        auto b = builder();
        b.model.tick_ns = std::llround(1e9 * tick_s);
        b.model.gravity.setZero();
        b.add_fixed_box("sheet", {0.002, 1, 1}, at(0, 0, 0));
        const double start = -0.002 - gap;
        const BodyId plate = b.add_box("plate", {0.002, 0.1, 0.1}, 0.1, at(start, 0, 0));
        b.body(plate).v_WB = {speed, 0, 0};
        b.add_joint("rail", world::JointKind::kSlider, {}, plate, {start, 0, 0}, {1, 0, 0});
        Lab lab(b.model);
        lab.run_ticks(10);
        EXPECT_NEAR(lab.body("plate").p_WC.x(), -0.002, 2e-4) << tick_s << " " << gap << " " << speed;
        EXPECT_EQ(lab.warned_ticks, 0) << tick_s << " " << gap << " " << speed;
      }
    }
  }
}

// A finger that a drive presses from rest. The tick is as long as any, and ends at the wall.
TEST_P(FastLinkedBodies, AFingerThatIsPressedFromRestStopsAtTheWall) {
  for (const double gap : {1e-3, 5e-3, 2e-2}) {
    auto b = builder();
    b.model.tick_ns = 10'000'000;
    b.add_fixed_box("wall", {0.004, 1, 1}, at(0, 0, 0));
    const double start = -0.007 - gap;
    const BodyId finger = b.add_box("finger", {0.01, 0.02, 0.02}, 0.1, at(start, 0, 0));
    b.add_joint("rail", world::JointKind::kSlider, {}, finger, {start, 0, 0}, {1, 0, 0});
    b.add_sphere("other", 0.1, 1.0, at(0, 50, 0));
    Lab lab(b.model);
    lab.drive("rail") = {.target_velocity = 0.0, .compliance = 1e9, .max_effort = 1e-9, .feedforward = 100.0};
    for (int k = 0; k < 20; ++k) {
      lab.run_ticks(1);
      ASSERT_LT(lab.body("finger").p_WC.x(), -0.006) << gap << " " << k;
    }
    EXPECT_NEAR(lab.body("finger").p_WC.x(), -0.007, 5e-4) << gap;
    EXPECT_NEAR(lab.normal_force_between("finger", "wall"), 100.0, 5.0) << gap;
    EXPECT_NEAR(lab.body("other").v_WC.z(), -9.81 * 0.2, 1e-6) << "no time is lost";
  }
}

// A rod on a hinge that turns by up to 1 rad in a tick, and a post near its end.
TEST_P(FastLinkedBodies, ARodDoesNotTurnThroughAPost) {
  const bool keeps_its_joint = GetParam().engine.name == "impulse";
  for (const double turn : {0.1, 0.3, 0.6, 1.0}) {
    for (int i = 0; i < 10; ++i) {
      auto b = builder();
      b.model.tick_ns = 10'000'000;
      b.model.gravity.setZero();
      const double angle = 0.2 + 0.1 * i * turn;  // before the post
      b.add_fixed_box("post", {0.02, 0.02, 0.3}, at(0.985, 0, 0));
      const BodyId rod = b.add_box("rod", {1.0, 0.02, 0.02}, 1.0,
                                   at(0.5 * std::cos(angle), -0.5 * std::sin(angle), 0, -angle, {0, 0, 1}));
      const double w = 100.0 * turn;
      b.body(rod).w_WB = {0, 0, w};
      b.body(rod).v_WB = 0.5 * w * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0);
      b.add_joint("pivot", world::JointKind::kHinge, {}, rod, {0, 0, 0}, {0, 0, 1});
      Lab lab(b.model);
      double most = 0.0;
      for (int k = 0; k < 20; ++k) {
        lab.run_ticks(1);
        most = std::max(most, lab.joint("pivot").position);
      }
      if (keeps_its_joint || turn < 0.2) {
        EXPECT_LT(most, angle) << turn << " rad in a tick, from " << angle;
      }
    }
  }
}

TEST_P(FastLinkedBodies, AMeshStopsABallOnARail) {
  auto b = shot(-1.02);
  make_boxes_sheets(b.model);
  Lab lab(b.model);
  lab.run_ticks(30);
  EXPECT_NEAR(lab.body("ball").p_WC.x(), -kRadiusM, 1e-3);
}

// A kinematic sheet that comes fast takes a ball on a rail with it.
TEST_P(FastLinkedBodies, AKinematicBodyPushesOneOnARail) {
  auto b = builder();
  b.model.gravity.setZero();
  const BodyId sheet = b.add_kinematic_box("sheet", {kSheetM, 1, 1}, at(-1.02, 0, 0));
  b.body(sheet).v_WB = {60.0, 0, 0};
  const BodyId ball = b.add_sphere("ball", kRadiusM, kBallKg, at(0, 0, 0));
  b.add_joint("rail", world::JointKind::kSlider, {}, ball, {0, 0, 0}, {1, 0, 0});
  Lab lab(b.model);
  for (int k = 0; k < 30; ++k) {
    lab.run_ticks(1);
    ASSERT_GT(lab.body("ball").p_WC.x(), lab.body("sheet").p_WC.x()) << k;
  }
  EXPECT_NEAR(lab.body("ball").v_WC.x(), 60.0, 1.0);
}

// A tick depends on its state alone: a world that is restored before the hit goes on with the same bits.
TEST_P(FastLinkedBodies, ARestoredWorldHitsAlike) {
  Lab lab(shot(-1.03, 0.3).model);
  lab.run_ticks(5);
  const world::WorldState kept = lab.state;
  lab.run_ticks(10);
  const std::uint64_t end = lab.hash();
  Lab other(shot(-1.03, 0.3).model);
  other.run_ticks(20);
  other.state = kept;
  other.run_ticks(10);
  EXPECT_EQ(other.hash(), end);
}

// A ball that bounces between two plates, many times its way in a tick apart. It stays between them.
TEST_P(FastLinkedBodies, ABallBetweenTwoPlatesStaysThere) {
  auto b = shot(kAtPlateM - 0.004, 1.0);
  b.add_fixed_box("other", {kSheetM, 2, 2}, at(2.0 * kAtPlateM - 0.008, 0, 0), {1});
  Lab lab(b.model);
  for (int i = 0; i < 100; ++i) {
    lab.run_ticks(1);
    ASSERT_NEAR(lab.body("ball").p_WC.x(), kAtPlateM - 0.004, 0.004 + 0.5 * kRadiusM) << i;
  }
}

}  // namespace
}  // namespace visum::dynamics::testing
