// `sleep` of the engine `impulse`: a body that stands still is left out until something happens to it.
#include <gtest/gtest.h>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/contact_models.h"

namespace visum::dynamics::testing {
namespace {

using world::JointKind;
constexpr double kSleep = 0.2;  // s

world::EngineSetting impulse(double sleep_s) {
  world::EngineSetting setting;
  setting.name = "impulse";
  setting.sleep_s = sleep_s;
  return setting;
}

// Two boxes on each other, one beside them, and a door that a drive holds.
ModelBuilder rooms(double sleep_s = kSleep) {
  ModelBuilder b(impulse(sleep_s));
  b.add_ground();
  b.add_box("below", {0.2, 0.2, 0.2}, 2.0, at(0, 0, 0.1));
  b.add_box("above", {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0.25));
  b.add_box("beside", {0.2, 0.2, 0.2}, 1.0, at(1, 0, 0.1));
  const BodyId door = b.add_box("door", {0.8, 0.05, 1.0}, 5.0, at(-2, 0, 1));
  b.add_joint("hinge", JointKind::kHinge, {}, door, {-2.4, 0, 1}, {0, 0, 1});
  return b;
}

struct Asleep : Lab {
  Asleep() : Lab(rooms().model) {
    drive("hinge") = {0.0, 1e-3, 5.0, 0.0};
    run(1.0);
  }
};

bool is_stopped(Lab& lab, const char* body) {
  return lab.body(body).v_WC.isZero(0.0) && lab.body(body).w_WB.isZero(0.0);
}

TEST(Sleep, WhatStandsStillKeepsItsPlaceAndItsForcesToTheBit) {
  Asleep lab;
  const world::WorldState before = lab.state;
  for (const char* body : {"below", "above", "beside", "door"}) EXPECT_TRUE(is_stopped(lab, body)) << body;
  lab.run(1.0);
  for (std::size_t i = 0; i < before.bodies.size(); ++i) {
    EXPECT_EQ(lab.state.bodies[i].p_WC, before.bodies[i].p_WC);
    EXPECT_EQ(lab.state.bodies[i].q_WB.coeffs(), before.bodies[i].q_WB.coeffs());
  }
  EXPECT_NEAR(lab.normal_force_between("below", "ground"), 3.0 * 9.81, 1e-3);
  EXPECT_NEAR(lab.normal_force_between("above", "below"), 9.81, 1e-3);
}

// A heap that stands gives what it gave when it falls asleep.
TEST(Sleep, FallingAsleepChangesNoForceOfWhatStands) {
  Lab lab(physics::piles(impulse(6.0), 1e-3, 1, 3));
  lab.run(6.0);
  int stood_all = 0, fell_asleep = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const std::vector<collision::Contact> before = lab.contacts;
    const std::size_t stood = lab.step().standing;
    ASSERT_EQ(before.size(), lab.contacts.size());
    stood_all += stood == lab.contacts.size();
    fell_asleep += stood_all > 0 && stood < lab.contacts.size();
    for (std::size_t i = 0; i < before.size(); ++i)
      ASSERT_LT((lab.contacts[i].force_on_a_W - before[i].force_on_a_W).norm(), 1e-12) << tick;
  }
  EXPECT_GT(stood_all, 100);
  EXPECT_GT(fell_asleep, 0);
}

TEST(Sleep, ABallThatRollingFrictionHoldsKeepsItsMomentToo) {
  ModelBuilder b(impulse(kSleep));
  b.model.gravity = {0.3, 0.0, -9.8};  // as on a slope
  const auto surface = b.add_surface(0.8, 0.0);
  b.model.surfaces[surface.index()].rolling_friction = 0.01;
  b.add_ground(surface);
  b.add_sphere("ball", 0.1, 2.0, at(0, 0, 0.1), surface);
  Lab lab(b.model);
  lab.run(0.5 * kSleep);
  ASSERT_FALSE(is_stopped(lab, "ball"));
  const Eigen::Vector3d awake = lab.contacts.at(0).torque_on_a_W;
  lab.run(2.0 * kSleep);
  ASSERT_TRUE(is_stopped(lab, "ball"));
  EXPECT_NEAR(awake.norm(), 2.0 * 0.3 * 0.1, 1e-3);
  EXPECT_LT((lab.contacts.at(0).torque_on_a_W - awake).norm(), 1e-3 * awake.norm());
}

TEST(Sleep, NothingSleepsUnlessAsked) {
  EXPECT_EQ(world::EngineSetting{}.sleep_s, 0.0);
  ModelBuilder b = rooms(0.0);
  b.model.gravity.setZero();
  b.add_box("slow", {0.1, 0.1, 0.1}, 1.0, at(0, 3, 3));
  b.model.bodies.back().v_WB = {1e-6, 0, 0};
  Lab lab(b.model);
  lab.run(2.0);
  EXPECT_NEAR(lab.body("slow").p_WC.x(), 2e-6, 1e-12);
}

TEST(Sleep, WhatFallsOnASleeperWakesAllThatItTouches) {
  ModelBuilder b = rooms();
  b.add_box("late", {0.1, 0.1, 0.1}, 1.0, at(0.02, 0, 3.5));  // comes down after 0.8 s
  Lab lab(b.model);
  lab.run(0.7);
  EXPECT_TRUE(is_stopped(lab, "below"));
  lab.run(0.15);
  EXPECT_FALSE(is_stopped(lab, "below"));
  EXPECT_TRUE(is_stopped(lab, "beside")) << "what it does not touch sleeps on";
  lab.run(2.0);
  EXPECT_TRUE(is_stopped(lab, "below"));
  EXPECT_TRUE(is_stopped(lab, "late"));
}

TEST(Sleep, APushWakesAsIfItHadNeverSlept) {
  Asleep lab;
  Lab awake(rooms(0.0).model);
  awake.run(1.0);
  for (Lab* each : {static_cast<Lab*>(&lab), &awake}) {
    const double before = each->body("beside").p_WC.x();
    each->wrenches = {{each->model.find_body("beside"), {15.0, 0, 0}, {0, 0, 0}}};
    each->run(0.2);
    const double a = 15.0 - 0.5 * 9.81;
    EXPECT_NEAR(each->body("beside").p_WC.x() - before, 0.5 * a * 0.04, 0.02 * a * 0.04);
  }
}

TEST(Sleep, ADriveThatIsGivenSomethingElseWakes) {
  Asleep lab;
  EXPECT_TRUE(is_stopped(lab, "door"));
  lab.drive("hinge").target_velocity = 0.5;
  lab.run(0.3);  // 5 N·m on 1.07 kg·m² need 0.11 s
  EXPECT_NEAR(lab.joint("hinge").velocity, 0.5, 1e-3);
  EXPECT_TRUE(is_stopped(lab, "below"));
}

TEST(Sleep, WhatIsMovedAwayFromBelowLetsItFall) {
  Asleep lab;
  lab.body("below").p_WC.x() += 5.0;
  lab.run(0.1);
  EXPECT_NEAR(lab.body("above").p_WC.z(), 0.25 - 0.5 * 9.81 * 0.01, 1e-3);
}

TEST(Sleep, AVelocityFromOutsideWakes) {
  Asleep lab;
  lab.body("beside").v_WC.z() = 2.0;
  lab.run(0.1);
  EXPECT_GT(lab.body("beside").p_WC.z(), 0.2);
}

TEST(Sleep, ARestoredAndAFreshWorldGoOnWithTheSameBits) {
  Asleep lab;
  for (const int before : {100, 350}) {  // asleep, and about to fall asleep
    const world::WorldState saved = lab.state;
    Lab fresh(rooms().model);
    fresh.state = saved;
    for (Lab* each : {static_cast<Lab*>(&lab), &fresh}) {
      each->drive("hinge") = {0.1, 1e-3, 5.0, 0.0};
      each->run_ticks(before);
    }
    EXPECT_EQ(lab.hash(), fresh.hash());
    lab.state = saved;
    lab.run_ticks(before);
    EXPECT_EQ(lab.hash(), fresh.hash());
  }
}

}  // namespace
}  // namespace visum::dynamics::testing
