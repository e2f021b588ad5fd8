#include <gmock/gmock.h>

#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {
namespace {

using world::JointKind;

class HardCases : public Contract {
 protected:
  // The engine survives if each tick is either good, with a finite state, or reported, and if the engine goes
  // on working.
  static void expect_survival(Lab& lab, int ticks) {
    const world::WorldState start = lab.state;
    for (int i = 0; i < ticks; ++i) {
      const StepResult result = lab.step();
      if (!result.ok) {
        EXPECT_FALSE(result.fault.empty());
        lab.state = start;
        lab.step();
        return;
      }
      ASSERT_TRUE(is_sane(lab.model, lab.state, nullptr));
    }
  }
};
VISUM_INSTANTIATE_CONTRACT(HardCases);

TEST_P(HardCases, ContradictoryJointsDoNotAbort) {
  auto b = builder();
  const BodyId beam = b.add_box("beam", {1.0, 0.1, 0.1}, 1.0, at(0, 0, 0));
  b.add_joint("left", JointKind::kFixed, {}, beam, {-0.5, 0, 0}, {0, 0, 1});
  b.add_joint("right", JointKind::kFixed, {}, beam, {0.5, 0, 0}, {0, 0, 1}).X_PJ.p.x() += 0.2;
  b.add_joint("hinge", JointKind::kHinge, {}, beam, {0, 0, 0}, {0, 1, 0}).X_PJ.p.z() -= 0.3;
  Lab lab(b.model);
  expect_survival(lab, 2000);
}

TEST_P(HardCases, TwoMotorsThatWantTheOppositeDoNotAbort) {
  auto b = builder();
  const BodyId rotor = b.add_rotor("rotor", 1.0, 1.0, at(0, 0, 0));
  b.add_joint("one", JointKind::kHinge, {}, rotor, {0, 0, 0}, {0, 0, 1});
  b.add_joint("two", JointKind::kHinge, {}, rotor, {0, 0, 0}, {0, 0, 1});
  Lab lab(b.model);
  lab.drive("one") = {1.0, 0.0, 1e6, 0.0};
  lab.drive("two") = {-1.0, 0.0, 1e6, 0.0};
  expect_survival(lab, 1000);
}

TEST_P(HardCases, AMassRatioOfAMillionDoesNotAbort) {
  auto b = builder();
  BodyId parent;
  for (int i = 0; i < 8; ++i) {
    const std::string name = "link_" + std::to_string(i);
    const BodyId link = b.add_box(name, {0.1, 0.02, 0.02}, i == 7 ? 1e5 : 0.1, at(0.05 + 0.1 * i, 0, 0));
    b.add_joint("joint_" + std::to_string(i), JointKind::kHinge, parent, link, {0.1 * i, 0, 0}, {0, 1, 0});
    parent = link;
  }
  Lab lab(b.model);
  expect_survival(lab, 2000);
}

TEST_P(HardCases, AHeavyBoxOnALightOneDoesNotAbort) {
  auto b = builder();
  b.add_ground();
  b.add_box("light", {0.1, 0.1, 0.1}, 1e-3, at(0, 0, 0.05));
  b.add_box("heavy", {0.1, 0.1, 0.1}, 1e3, at(0, 0, 0.15));
  Lab lab(b.model);
  expect_survival(lab, 2000);
}

TEST_P(HardCases, AHeapOfThirtyThingsDoesNotAbort) {
  auto b = builder();
  b.add_ground();
  for (int i = 0; i < 30; ++i) {
    const Pose place = at(0.03 * (i % 3), 0.02 * (i % 5), 0.2 + 0.12 * i, 0.7 * i, {1, 2, 3});
    const std::string name = "thing_" + std::to_string(i);
    if (i % 3 == 0) b.add_box(name, {0.1, 0.15, 0.08}, 0.5, place);
    if (i % 3 == 1) b.add_sphere(name, 0.06, 0.5, place);
    if (i % 3 == 2) b.add_cylinder(name, 0.05, 0.12, 0.5, place);
  }
  Lab lab(b.model);
  expect_survival(lab, 1500);
  for (int i = 0; i < 30; ++i) EXPECT_GT(lab.body("thing_" + std::to_string(i)).p_WC.z(), 0.0) << i;
}

TEST_P(HardCases, AMassOfAGramAndSpinsOfThousandsOfTurnsDoNotAbort) {
  auto b = builder();
  b.add_ground();
  const BodyId top = b.add_box("top", {0.05, 0.02, 0.01}, 1e-3, at(0, 0, 0.3));
  b.body(top).w_WB = {3e4, 1e4, -2e4};
  Lab lab(b.model);
  expect_survival(lab, 1000);
}

// Each engine moves its own bodies. For each, the other's bodies move as that engine moves them.
class TwoEngines : public ::testing::TestWithParam<std::tuple<Row, Row>> {
 protected:
  ModelBuilder builder() const {
    ModelBuilder b(std::get<0>(GetParam()).engine);
    b.model.engines.push_back(std::get<1>(GetParam()).engine);
    return b;
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, TwoEngines,
                         ::testing::Combine(::testing::ValuesIn(rows()), ::testing::ValuesIn(rows())),
                         [](const auto& info) {
                           return std::get<0>(info.param).name + "And" + std::get<1>(info.param).name;
                         });

TEST_P(TwoEngines, EachMovesItsOwnBodiesAsIfItWereAlone) {
  auto b = builder();
  b.add_ground();
  b.add_box("mine", {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0.5, 0.2, {1, 1, 0}));
  const BodyId theirs = b.add_box("theirs", {0.1, 0.1, 0.1}, 1.0, at(3, 0, 0.5, 0.2, {1, 1, 0}));
  b.body(theirs).engine = 1;
  ModelBuilder alone(std::get<0>(GetParam()).engine);
  alone.add_ground();
  alone.add_box("mine", {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0.5, 0.2, {1, 1, 0}));
  Lab both(b.model), single(alone.model);
  both.run(1.0);
  single.run(1.0);
  EXPECT_EQ(both.body("mine").p_WC, single.body("mine").p_WC);
  EXPECT_EQ(both.body("mine").q_WB.coeffs(), single.body("mine").q_WB.coeffs());
  EXPECT_NEAR(both.body("theirs").p_WC.z(), 0.05, 2e-3);
}

TEST_P(TwoEngines, ABoxStandsOnAnotherEnginesBox) {
  auto b = builder();
  b.add_ground();
  b.add_box("below", {0.2, 0.2, 0.2}, 5.0, at(0, 0, 0.1));
  b.body(b.add_box("above", {0.1, 0.1, 0.1}, 0.5, at(0, 0, 0.25))).engine = 1;
  Lab lab(b.model);
  lab.run(1.0);
  EXPECT_NEAR(lab.body("above").p_WC.z(), 0.25, 2e-3);
  EXPECT_NEAR(lab.body("below").p_WC.z(), 0.1, 2e-3);
}

TEST_P(TwoEngines, ABeltOfAnotherEngineCarriesABoxAlong) {
  auto b = builder();
  const BodyId belt = b.add_box("belt", {10, 1, 0.1}, 1e4, at(0, 0, -0.05));
  b.add_joint("run", JointKind::kSlider, {}, belt, {0, 0, 0}, {1, 0, 0});
  b.body(b.add_box("box", {0.1, 0.1, 0.1}, 0.5, at(0, 0, 0.05))).engine = 1;
  Lab lab(b.model);
  lab.drive("run") = {0.5, 0.0, 1e6, 0.0};
  lab.run(1.0);
  EXPECT_NEAR(lab.body("box").v_WC.x(), 0.5, 0.01);
}

}  // namespace
}  // namespace visum::dynamics::testing
