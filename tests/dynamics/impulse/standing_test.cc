// Islands that stand are not computed anew: with the same bits as those of an engine that computes them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "server/dynamics/kinds/engine_kinds.h"
#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/contact_models.h"

namespace visum::dynamics::testing {
namespace {

using Eigen::Vector3d;

world::EngineSetting impulse() {
  world::EngineSetting setting;
  setting.name = "impulse";
  return setting;
}

// Two towers of three, apart from each other, and a ball that lies between them.
void add_towers(ModelBuilder& b) {
  for (const std::string side : {"left", "right"})
    for (int i = 0; i < 3; ++i)
      b.add_box(side + std::to_string(i), {0.2, 0.2, 0.2}, 1.0 + i,
                at(side == "left" ? -1.0 : 1.0, 0, 0.1 + 0.2 * i - physics::kTouch * (i + 1)));
  b.add_sphere("ball", 0.1, 1.0, at(0, 0, 0.1 - physics::kTouch));
}

world::WorldModel two_towers(const world::EngineSetting& setting) {
  ModelBuilder b(setting);
  b.add_ground();
  add_towers(b);
  return b.model;
}

// Contacts of a tower: four for each pair.
constexpr std::size_t kOfTower = 12;

// An engine that is made anew knows nothing of the tick before.
StepResult step_anew(Lab& lab) {
  lab.engines[0] = make_engine(lab.model, 0);
  return lab.step();
}

bool are_same_forces(const std::vector<collision::Contact>& a, const std::vector<collision::Contact>& b) {
  return std::ranges::equal(a, b, [](const collision::Contact& x, const collision::Contact& y) {
    return std::memcmp(&x.normal_force_n, &y.normal_force_n, sizeof(double)) == 0 &&
           x.force_on_a_W == y.force_on_a_W && x.torque_on_a_W == y.torque_on_a_W;
  });
}

// Steps both. Returns what the first one tells.
StepResult step_alike(Lab& lab, Lab& fresh) {
  const StepResult result = lab.step(), anew = step_anew(fresh);
  EXPECT_TRUE(result.ok && anew.ok);
  EXPECT_EQ(anew.standing, 0u);
  EXPECT_EQ(lab.bytes(), fresh.bytes()) << "tick " << lab.state.tick;
  EXPECT_TRUE(are_same_forces(lab.contacts, fresh.contacts)) << "tick " << lab.state.tick;
  EXPECT_EQ(result.work, anew.work) << "tick " << lab.state.tick;
  EXPECT_EQ(result.warned, anew.warned);
  EXPECT_EQ(result.limited, anew.limited);
  EXPECT_EQ(result.fell_short, anew.fell_short);
  return result;
}

TEST(Standing, WhatHasComeToRestIsNotComputedAnew) {
  Lab lab(two_towers(impulse())), fresh(two_towers(impulse()));
  for (int tick = 0; tick < 300; ++tick) {
    step_alike(lab, fresh);
    ASSERT_FALSE(HasFailure());
  }
  for (int tick = 0; tick < 100; ++tick) ASSERT_EQ(step_alike(lab, fresh).standing, 2 * kOfTower + 1);
}

// A heap's solutions miss a little in each tick, which alone would keep it from being frozen.
TEST(Standing, AHeapComesToStand) {
  Lab lab(physics::piles(impulse(), 1e-3, 1, 10));
  lab.run(6.0);
  const StepResult result = lab.step();
  EXPECT_GT(result.standing, 20u);
  EXPECT_EQ(result.standing, lab.contacts.size());
}

// Only the island that is disturbed is computed, in the very tick.
class Disturbed : public ::testing::Test {
 protected:
  Disturbed() {
    lab.run(0.3);
    fresh.state = lab.state;
    fresh.run_ticks(1);
    lab.run_ticks(1);
  }

  void disturb(const std::function<void(Lab&)>& by) {
    by(lab);
    by(fresh);
    EXPECT_EQ(step_alike(lab, fresh).standing, kOfTower + 1);
    lab.wrenches.clear();
    fresh.wrenches.clear();
    for (int tick = 0; tick < 50; ++tick) EXPECT_GE(step_alike(lab, fresh).standing, kOfTower + 1);
  }

  Lab lab{two_towers(impulse())}, fresh{two_towers(impulse())};
};

TEST_F(Disturbed, ByAForce) {
  disturb([](Lab& of) {
    of.wrenches.push_back(
        {.body = of.model.find_body("left2"), .force_n = {0, 0, 1e-12}, .torque_nm = Vector3d::Zero()});
  });
}

TEST_F(Disturbed, ByAVelocity) {
  disturb([](Lab& of) { of.body("left1").w_WB.z() = 1e-300; });
}

TEST_F(Disturbed, ByAPlace) {
  disturb([](Lab& of) {
    double& z = of.body("left0").p_WC.z();
    z = std::nextafter(z, 1.0);
  });
}

// The fourth record is one of the left tower's contacts. `at`: a place in it, as warm_start.h has it.
template <typename Number>
void change_record(Lab& of, std::size_t at, Number (*change)(Number)) {
  std::vector<std::byte>& kept = of.state.engines[0];
  std::byte* const place = &kept[3 * (kept.size() / (2 * kOfTower + 1)) + at];
  Number number{};
  std::memcpy(&number, place, sizeof number);
  number = change(number);
  std::memcpy(place, &number, sizeof number);
}

TEST_F(Disturbed, ByAnImpulseInItsMemory) {
  disturb([](Lab& of) {
    change_record<double>(of, 32, [](double z) {
      EXPECT_NE(z, 0.0);
      return std::nextafter(z, 100.0);
    });
  });
}

void land_deeper(Lab& of) {
  change_record<std::int32_t>(of, 12, [](std::int32_t rest) { return rest + 20; });  // by 10 nm
}

TEST_F(Disturbed, ByALandingInItsMemory) {
  disturb(land_deeper);
}

// A floor that sinks by the last bit has other contacts, and no body of an island has moved.
TEST_F(Disturbed, ByTheFloor) {
  for (Lab* of : {&lab, &fresh}) of->body("ground").p_WC.z() = -1e-17;
  EXPECT_EQ(step_alike(lab, fresh).standing, 0u);
}

// A tick that stops something does not end as it began, and stops it again where it begins so again.
TEST_F(Disturbed, ByATickThatComesAgain) {
  disturb([](Lab& of) { of.body("left1").w_WB.z() = 1e-300; });
  for (Lab* of : {&lab, &fresh}) of->body("left1").w_WB.z() = 1e-300;
  const world::WorldState moving = lab.state;
  for (int again = 0; again < 3; ++again) {
    lab.state = fresh.state = moving;
    step_alike(lab, fresh);
    EXPECT_EQ(lab.body("left1").w_WB.z(), 0.0);
  }
}

// With everything that may come between two ticks, in any order.
TEST(Standing, BitsAreThoseOfAnEngineThatComputesAll) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    world::EngineSetting setting = impulse();
    setting.threads = seed == 3 ? 2 : 1;
    Lab lab(two_towers(setting)), fresh(two_towers(setting));
    std::mt19937 random(seed);
    const auto below = [&](unsigned n) { return random() % n; };
    std::vector<world::WorldState> history;
    std::size_t stood = 0;
    for (int tick = 0; tick < 3000; ++tick) {
      history.push_back(lab.state);
      lab.wrenches.clear();
      if (below(100) == 0) {
        const std::size_t body = 1 + below(7);
        ASSERT_FALSE(lab.model.bodies[body].fixed);
        world::BodyState& of = lab.state.bodies[body];
        const double small = std::pow(10.0, -1.0 * below(16));
        switch (below(6)) {
          case 0:
            lab.wrenches.push_back({.body = {static_cast<std::int32_t>(body)},
                                    .force_n = {small, 0, 0},
                                    .torque_nm = Vector3d::Zero()});
            break;
          case 1:
            of.v_WC.x() += small;
            break;
          case 2:
            of.w_WB.z() += small;
            break;
          case 3:
            of.p_WC.z() += 0.1 * small;
            break;
          case 4:
            lab.state = history[below(static_cast<unsigned>(history.size()))];
            break;
          default:  // the ball falls on a tower
            lab.body("ball").p_WC = {below(2) == 0 ? 1.05 : -1.02, 0.03, 0.8};
        }
      }
      fresh.state = lab.state;
      fresh.wrenches = lab.wrenches;
      stood += step_alike(lab, fresh).standing;
      ASSERT_FALSE(HasFailure()) << "seed " << seed;
    }
    EXPECT_GT(stood, 3000u) << "seed " << seed;
  }
}

// A ball that rolling friction holds on a slope.
TEST(Standing, WhatStandsGivesItsMomentToo) {
  ModelBuilder b(impulse());
  b.model.surfaces.front().rolling_friction = 0.01;
  const double slope = 0.03;  // rad
  b.add_fixed_box("slope", {2, 2, 0.2}, at(0, 0, 0, slope, {0, 1, 0}));
  const double up = 0.2 - physics::kTouch;  // m, from the box' centre, along its normal
  b.add_sphere("ball", 0.1, 1.0, at(up * std::sin(slope), 0, up * std::cos(slope)));
  Lab lab(b.model), fresh(b.model);
  for (int tick = 0; tick < 1000; ++tick) {
    step_alike(lab, fresh);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(step_alike(lab, fresh).standing, 1u);
  EXPECT_NEAR(lab.contacts.at(0).torque_on_a_W.norm(), 9.81 * 0.1 * std::sin(slope), 1e-6);
}

// The plate may begin to move, and its speed is no part of the contact.
TEST(Standing, NothingStandsOnWhatTheSceneMoves) {
  ModelBuilder b(impulse());
  b.add_kinematic_box("plate", {1, 1, 0.1}, at(0, 0, -0.05));
  b.add_box("box", {0.2, 0.2, 0.2}, 1.0, at(0, 0, 0.1 - physics::kTouch));
  Lab lab(b.model), fresh(b.model);
  for (int tick = 0; tick < 400; ++tick) {
    for (Lab* of : {&lab, &fresh}) of->body("plate").v_WC.x() = tick < 300 ? 0.0 : 0.1;
    EXPECT_EQ(step_alike(lab, fresh).standing, 0u);
    ASSERT_FALSE(HasFailure());
  }
}

// Steps that are not the same from tick to tick.
TEST(Standing, NothingStandsWithOtherKindsOfSteps) {
  world::EngineSetting iterate = impulse(), fourth = impulse();
  iterate.solver = "iterate";
  fourth.order = 4;
  for (const world::EngineSetting& setting : {iterate, fourth}) {
    Lab lab(two_towers(setting));
    for (int tick = 0; tick < 400; ++tick) ASSERT_EQ(lab.step().standing, 0u);
  }
}

// The work that an island would have taken counts: the pile beside the towers meets the limit in the same
// ticks, and ends with the same bits.
TEST(Standing, ALimitOfWorkIsMetAlike) {
  world::EngineSetting setting = impulse();
  setting.work_limit = 40'000;
  ModelBuilder b(setting);
  b.add_ground();
  for (int i = 0; i < 27; ++i)
    b.add_box("fallen" + std::to_string(i), {0.1, 0.1, 0.1}, 1.0,
              at(5 + 0.12 * (i % 3), 0.12 * (i / 3 % 3), 1.2 + 0.12 * (i / 9), 0.3 * i, {0.3, 1, 0.2}));
  add_towers(b);
  Lab lab(b.model), fresh(b.model);
  int limited = 0, stood = 0;
  for (int tick = 0; tick < 900; ++tick) {
    const StepResult result = step_alike(lab, fresh);
    stood += result.standing >= 2 * kOfTower;
    limited += result.limited && tick > 300;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(stood, 100);
  EXPECT_GT(limited, 5);
}

// A tick that is made in shorter steps is computed as a whole: here a heavy end that hangs on light rods is
// kicked.
TEST(Standing, NothingStandsInATickThatIsCut) {
  ModelBuilder b(impulse());
  b.add_ground();
  add_towers(b);
  BodyId last;
  for (int i = 0; i < 4; ++i) {
    const double mass_kg = i == 3 ? 10.0 : 0.01;
    const BodyId rod =
        b.add_box("rod" + std::to_string(i), {0.01, 0.01, 0.2}, mass_kg, at(5, 0, 5.9 - 0.2 * i));
    b.add_joint("hinge" + std::to_string(i), world::JointKind::kHinge, last, rod, {5, 0, 6.0 - 0.2 * i},
                {0, 1, 0});
    last = rod;
  }
  Lab lab(b.model), fresh(b.model);
  for (Lab* of : {&lab, &fresh}) {
    of->run(0.3);
    of->body("rod3").v_WC.x() = 5.0;
  }
  int cut = 0, stood = 0;
  for (int tick = 0; tick < 400; ++tick) {
    const StepResult result = step_alike(lab, fresh);
    EXPECT_TRUE(!result.warned || result.standing == 0) << tick;
    cut += result.warned;
    stood += result.standing == 2 * kOfTower + 1;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(cut, 10);
  EXPECT_GT(stood, 10);
}

}  // namespace
}  // namespace visum::dynamics::testing
