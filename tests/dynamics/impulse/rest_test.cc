// A body that stands still is left as it is, and not solved for anew in each tick.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/contact_models.h"

namespace visum::dynamics::testing {
namespace {

world::EngineSetting impulse() {
  world::EngineSetting setting;
  setting.name = "impulse";
  return setting;
}

// On the way there its impulses stop it. The rest of that must not be answered by the next tick, and so on
// for ever.
TEST(Rest, ForcesOfWhatStandsStillNoLongerChange) {
  ModelBuilder b(impulse());
  b.add_ground();
  b.add_box("below", {0.2, 0.2, 0.2}, 2.0, at(0, 0, 0.1));
  b.add_box("above", {0.1, 0.1, 0.1}, 1.0, at(0.02, 0, 0.25));
  b.add_box("fallen", {0.2, 0.1, 0.1}, 1.0, at(1, 0, 0.06));
  Lab lab(b.model);
  lab.run(1.0);
  int changes = 0;
  double last = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_TRUE(lab.step().ok);
    const double force = lab.normal_force_between("fallen", "ground");
    changes += std::abs(force - last) > 1e-11 * 9.81;
    last = force;
  }
  EXPECT_NEAR(last, 9.81, 1e-6);
  EXPECT_LT(changes, 50);
}

// The little that is left of its overlaps would otherwise move it for ever: by 1e-11 m/s, and with a solution
// in each tick.
TEST(Rest, AWallThatStandsStaysAsItIsToTheLastBit) {
  for (const int side : {1, 10}) {
    Lab lab(physics::standing_wall(impulse(), 1e-3, side));
    lab.run(0.2);
    const world::WorldState before = lab.state;
    for (int tick = 0; tick < 200; ++tick) {
      ASSERT_TRUE(lab.step().ok);
      for (const auto& body : lab.state.bodies) {
        ASSERT_EQ(body.v_WC, Eigen::Vector3d::Zero()) << tick;
        ASSERT_EQ(body.w_WB, Eigen::Vector3d::Zero()) << tick;
      }
    }
    EXPECT_TRUE(lab.state.engines == before.engines) << side;
    for (std::size_t i = 0; i < before.bodies.size(); ++i) {
      EXPECT_EQ(lab.state.bodies[i].p_WC, before.bodies[i].p_WC) << i;
      EXPECT_EQ(lab.state.bodies[i].q_WB.coeffs(), before.bodies[i].q_WB.coeffs()) << i;
    }
    double weight = 0.0, carried = 0.0;  // N
    for (const auto& body : lab.model.bodies)
      if (!body.fixed) weight += 9.81 * body.mass_kg;
    for (const auto& contact : lab.contacts)
      if (!contact.body_a.valid() || lab.model.bodies[contact.body_a.index()].fixed)
        carried -= contact.force_on_a_W.z();
    EXPECT_NEAR(carried, weight, 1e-9 * weight) << side;
  }
}

// They begin with overlaps of a micrometre. What a solution may miss would keep the wall moving; and to take
// all overlaps out at once would throw a high stack up.
TEST(Rest, StacksAndWallsComeToStandSoon) {
  const auto ticks_until_it_stands = [](const world::WorldModel& model) {
    Lab lab(model);
    int ticks = 1;
    while (lab.step().standing < lab.contacts.size() && ticks < 400) ++ticks;
    return ticks;
  };
  EXPECT_LT(ticks_until_it_stands(physics::towers(impulse(), 1e-3, 1, 10)), 15);
  EXPECT_LT(ticks_until_it_stands(physics::standing_wall(impulse(), 1e-3, 14)), 15);
  EXPECT_LT(ticks_until_it_stands(physics::stack(impulse(), 1e-3, 50)), 20);
  EXPECT_LT(ticks_until_it_stands(physics::stack(impulse(), 1e-3, 200)), 200);
}

world::WorldModel puck_on_ice() {
  ModelBuilder b(impulse());
  b.add_ground();
  b.add_box("puck", {0.2, 0.2, 0.1}, 1.0, at(0, 0, 0.05 - physics::kTouch));
  b.model.surfaces.front().friction = 0.0;
  return b.model;
}

// A millionth of its weight moves a body that nothing holds, as far as it should.
TEST(Rest, ASmallForceIsEnoughToBegin) {
  Lab lab(puck_on_ice());
  lab.run(0.2);
  ASSERT_EQ(lab.body("puck").v_WC, Eigen::Vector3d::Zero());
  const double force = 1e-6 * 9.81;  // N
  lab.wrenches.push_back({lab.model.find_body("puck"), {force, 0, 0}, Eigen::Vector3d::Zero()});
  const double start = lab.body("puck").p_WC.x();
  lab.run(1.0);
  EXPECT_NEAR(lab.body("puck").v_WC.x(), force, 1e-6 * force);
  EXPECT_NEAR(lab.body("puck").p_WC.x() - start, 0.5 * force, 2e-3 * force);
}

// A light body beneath a heavy one must not change that, although it is moved by a thousand times as much.
TEST(Rest, ASmallForceIsEnoughForATonneOnALightShim) {
  ModelBuilder b(impulse());
  b.add_ground();
  b.model.surfaces.front().friction = 0.0;
  b.add_box("shim", {0.5, 0.5, 0.02}, 1.0, at(0, 0, 0.01 - physics::kTouch));
  b.add_box("load", {0.5, 0.5, 0.5}, 1000.0, at(0, 0, 0.27 - 2.0 * physics::kTouch));
  Lab lab(b.model);
  lab.run(1.0);
  const double force = 1e-5 * 9.81 * 1000.0;  // N
  lab.wrenches.push_back({lab.model.find_body("load"), {force, 0, 0}, Eigen::Vector3d::Zero()});
  lab.run(0.1);
  const double speed = 0.1 * force / 1000.0;
  EXPECT_NEAR(lab.body("load").v_WC.x(), speed, 0.01 * speed);
}

// A belt drags what stands on it, however slowly it moves, and whatever a solution may miss there.
TEST(Rest, ATonneOnALightShimFollowsASlowBelt) {
  ModelBuilder b(impulse());
  b.add_kinematic_box("belt", {4, 4, 0.1}, at(0, 0, -0.05));
  b.add_box("shim", {0.2, 0.2, 0.2}, 0.1, at(0, 0, 0.1 - physics::kTouch));
  b.add_box("load", {0.2, 0.2, 0.2}, 1000.0, at(0, 0, 0.3 - 2.0 * physics::kTouch));
  Lab lab(b.model);
  lab.run(1.0);
  const double start = lab.body("load").p_WC.x(), speed = 1e-6;
  lab.body("belt").v_WC.x() = speed;
  lab.run(1.0);
  EXPECT_NEAR(lab.body("load").p_WC.x() - start, speed, 0.01 * speed);
}

// Impulses that held a body hold it no more where they miss what they should give.
TEST(Rest, WhatIsFrozenSlipsWhereItsFrictionIsGone) {
  ModelBuilder b(impulse());
  b.model.gravity = {3.0, 0.0, -9.0};  // as on a slope
  b.add_ground();
  b.add_box("box", {0.2, 0.2, 0.2}, 1.0, at(0, 0, 0.1 - physics::kTouch));
  Lab rough(b.model);
  rough.run(1.0);
  ASSERT_LT(rough.body("box").v_WC.norm(), 1e-12);
  b.model.surfaces.front().friction = 0.1;
  Lab slippery(b.model);
  slippery.state = rough.state;
  slippery.run(1.0);
  EXPECT_NEAR(slippery.body("box").v_WC.x(), 3.0 - 0.1 * 9.0, 1e-3);
}

TEST(Rest, WhatIsFrozenIsLiftedWhereItsFloorRises) {
  ModelBuilder b(impulse());
  b.add_ground();
  b.add_box("box", {0.2, 0.2, 0.2}, 1.0, at(0, 0, 0.1 - physics::kTouch));
  Lab lab(b.model);
  lab.run(1.0);
  ASSERT_EQ(lab.body("box").v_WC, Eigen::Vector3d::Zero());
  const double height = lab.body("box").p_WC.z(), rise = 1e-4;  // m
  lab.body("ground").p_WC.z() += rise;
  lab.run(1.0);
  EXPECT_NEAR(lab.body("box").p_WC.z() - height, rise, 0.01 * rise);
}

// Nor is a slow motion taken for rest.
TEST(Rest, ASlowBodySlidesOnWhereNothingRubs) {
  Lab lab(puck_on_ice());
  lab.run(0.5);
  lab.body("puck").v_WC.x() = 1e-7;
  lab.run(1.0);
  EXPECT_NEAR(lab.body("puck").v_WC.x(), 1e-7, 1e-13);
}

}  // namespace
}  // namespace visum::dynamics::testing
