// Steps whose joints do not close are cut in halves, and refused with the joint's name where that does not
// help.
#include <gmock/gmock.h>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::dynamics::testing {
namespace {

using world::JointKind;

world::EngineSetting halving_engine(int order) {
  world::EngineSetting setting;
  setting.name = "impulse";
  setting.order = order;
  return setting;
}

// Two swinging rods, beside a bar of 1 m between two points that are 1.2 m apart.
world::WorldModel bar_too_short(int order) {
  ModelBuilder b(halving_engine(order));
  const BodyId upper = b.add_box("upper", {1.0, 0.1, 0.1}, 1.0, at(0.5, 3, 0));
  const BodyId lower = b.add_box("lower", {1.0, 0.1, 0.1}, 1.0, at(1.5, 3, 0));
  b.add_joint("shoulder", JointKind::kHinge, {}, upper, {0, 3, 0}, {0, 1, 0});
  b.add_joint("elbow", JointKind::kHinge, upper, lower, {1, 3, 0}, {0, 1, 0});
  const BodyId bar = b.add_box("bar", {1.0, 0.1, 0.1}, 1.0, at(0, 0, 0));
  b.add_joint("left", JointKind::kBall, {}, bar, {-0.5, 0, 0}, {0, 0, 1});
  b.add_joint("right", JointKind::kBall, {}, bar, {0.5, 0, 0}, {0, 0, 1}).X_PJ.p.x() += 0.2;
  return b.model;
}

class Halving : public ::testing::TestWithParam<int> {
 protected:
  world::EngineSetting engine() const { return halving_engine(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Orders, Halving, ::testing::Values(2, 4, 6),
                         [](const auto& info) { return "Order" + std::to_string(info.param); });

TEST_P(Halving, WhatCannotBeHeldIsToldByNameAndTheStateStaysAsItWas) {
  Lab lab(bar_too_short(GetParam()));
  const auto before = lab.bytes();
  for (int i = 0; i < 2; ++i) {
    const StepResult result = lab.step();
    ASSERT_FALSE(result.ok);
    EXPECT_THAT(result.fault,
                ::testing::MatchesRegex("joint '(left|right)' on body 'bar' cannot be held together"));
    EXPECT_EQ(lab.bytes(), before) << "of the rods, too, which nothing ails";
  }
}

// The chain goes on from its good state, though the engine has tried in vain meanwhile.
TEST_P(Halving, AnEngineThatHasFailedGoesOnFromAGoodState) {
  const auto model = physics::chain(engine(), 1e-3, 4);
  Lab straight(model), failing(model);
  for (Lab* lab : {&straight, &failing}) lab->run_ticks(20);
  const world::WorldState good = failing.state;
  failing.state.bodies[1].p_WC.x() += 1e4;
  const StepResult result = failing.step();
  ASSERT_FALSE(result.ok);
  EXPECT_THAT(result.fault, ::testing::HasSubstr("cannot be held together"));
  failing.state = good;
  for (Lab* lab : {&straight, &failing}) lab->run_ticks(20);
  EXPECT_EQ(straight.hash(), failing.hash());
}

// A free arm of seven links, in ticks during which its wrist turns too far for one step.
TEST_P(Halving, AStepThatDoesNotCloseIsMadeOfShorterOnesAndIsTold) {
  constexpr int kTicks = 50;
  Lab lab(physics::arm7(engine(), 4e-2));
  for (int i = 0; i < kTicks; ++i) {
    ASSERT_TRUE(lab.step().ok) << i;
    ASSERT_LT(physics::max_gap(lab.model, lab.state), 2e-7) << i;
  }
  EXPECT_GT(lab.warned_ticks, 0) << "the case is no longer the one that is meant";
  EXPECT_LT(lab.warned_ticks, kTicks) << "the first ticks are slow: none of them is to be cut";
}

TEST(HalvingOfOrder2, ATickThatIsCutIsTwoOfHalfTheLength) {
  const auto setting = halving_engine(2);
  Lab lab(physics::arm7(setting, 4e-2)), halves(physics::arm7(setting, 2e-2));
  world::WorldState before;
  while (lab.warned_ticks == 0) {
    ASSERT_LT(lab.state.tick, 100) << "the case is no longer the one that is meant";
    before = lab.state;
    lab.run_ticks(1);
  }
  halves.state = before;
  halves.run_ticks(2);
  for (std::size_t i = 0; i < lab.state.bodies.size(); ++i) {
    const auto &whole = lab.state.bodies[i], &twice = halves.state.bodies[i];
    EXPECT_LT((whole.p_WC - twice.p_WC).norm(), 1e-7) << i;
    EXPECT_LT((whole.v_WC - twice.v_WC).norm(), 1e-5) << i;
  }
}

}  // namespace
}  // namespace visum::dynamics::testing
