#include <gmock/gmock.h>

#include <functional>
#include <limits>

#include "tests/dynamics/contract/scenes.h"

// ODE 0.16.2 loses 80 bytes of its own each time it gives up in the middle of a step.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:PreallocateJobInfos";
}

namespace visum::dynamics::testing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

class BadNumbers : public Contract {};
VISUM_INSTANTIATE_CONTRACT(BadNumbers);

struct Poison {
  const char* name;
  const char* named;  // the fault must name it
  std::function<void(Lab&, double)> apply;
};

const std::vector<Poison> kInputs{
    {"target_velocity", "shoulder", [](Lab& lab, double x) { lab.drive("shoulder").target_velocity = x; }},
    {"compliance", "shoulder", [](Lab& lab, double x) { lab.drive("shoulder").compliance = x; }},
    {"max_effort", "shoulder", [](Lab& lab, double x) { lab.drive("shoulder").max_effort = x; }},
    {"feedforward", "slide", [](Lab& lab, double x) { lab.drive("slide").feedforward = x; }},
    {"force", "ball",
     [](Lab& lab, double x) {
       lab.wrenches = {{lab.model.find_body("ball"), {0, x, 0}, Eigen::Vector3d::Zero()}};
     }},
    {"torque", "ball",
     [](Lab& lab, double x) {
       lab.wrenches = {{lab.model.find_body("ball"), Eigen::Vector3d::Zero(), {0, 0, x}}};
     }},
};

const std::vector<Poison> kStates{
    {"position", "lower", [](Lab& lab, double x) { lab.body("lower").p_WC.y() = x; }},
    {"orientation", "lower", [](Lab& lab, double x) { lab.body("lower").q_WB.x() = x; }},
    {"velocity", "lower", [](Lab& lab, double x) { lab.body("lower").v_WC.x() = x; }},
    {"angular velocity", "lower", [](Lab& lab, double x) { lab.body("lower").w_WB.z() = x; }},
};

TEST_P(BadNumbers, AnInputThatIsNotFiniteIsRefusedByNameAndChangesNothing) {
  for (const Poison& poison : kInputs) {
    for (const double value : {kNan, kInf, -kInf}) {
      Lab lab(busy_model(GetParam().engine)), clean(busy_model(GetParam().engine));
      for (Lab* each : {&lab, &clean}) {
        set_busy_drives(*each);
        each->run_ticks(100);
      }
      const auto before = lab.bytes();
      poison.apply(lab, value);
      const StepResult result = lab.step();
      EXPECT_FALSE(result.ok) << poison.name << " " << value;
      EXPECT_THAT(result.fault, ::testing::HasSubstr(poison.named));
      EXPECT_EQ(lab.bytes(), before) << poison.name << " " << value;
      lab.drives = clean.drives;
      lab.wrenches.clear();
      lab.run_ticks(50);
      clean.run_ticks(50);
      EXPECT_EQ(lab.hash(), clean.hash()) << poison.name << " " << value;
    }
  }
}

TEST_P(BadNumbers, AStateThatIsNotFiniteIsRefusedByName) {
  for (const Poison& poison : kStates) {
    for (const double value : {kNan, kInf, -kInf, 1e308}) {
      Lab lab(busy_model(GetParam().engine));
      lab.run_ticks(10);
      poison.apply(lab, value);
      const StepResult result = lab.step();
      EXPECT_FALSE(result.ok) << poison.name << " " << value;
      EXPECT_THAT(result.fault, ::testing::HasSubstr(poison.named));
    }
  }
}

TEST_P(BadNumbers, AnAbsurdlyLargeInputIsSurvivedAndReportedWhenItExplodes) {
  for (const Poison& poison : kInputs) {
    for (const double value : {1e308, 1e200, 1e30}) {
      Lab lab(busy_model(GetParam().engine));
      const world::WorldState good = lab.state;
      poison.apply(lab, value);
      StepResult result;
      for (int i = 0; i < 20 && result.ok; ++i) result = lab.step();
      if (!result.ok) {
        EXPECT_THAT(result.fault, ::testing::HasSubstr("body '")) << poison.name << " " << value;
      }
      lab.drives.assign(lab.drives.size(), {});
      lab.wrenches.clear();
      lab.state = good;
      EXPECT_TRUE(lab.step().ok) << poison.name << " " << value;
    }
  }
}

TEST_P(BadNumbers, AnExplosionIsReportedWithTheBodysName) {
  Lab lab(busy_model(GetParam().engine));
  lab.wrenches = {{lab.model.find_body("ball"), {0, 1e12, 0}, Eigen::Vector3d::Zero()}};
  const StepResult result = lab.step();
  EXPECT_FALSE(result.ok);
  EXPECT_THAT(result.fault, ::testing::HasSubstr("body 'ball'"));
}

TEST_P(BadNumbers, AfterAFaultTheEngineGoesOnFromAGoodStateWithTheSameBits) {
  Lab lab(busy_model(GetParam().engine)), clean(busy_model(GetParam().engine));
  for (Lab* each : {&lab, &clean}) {
    set_busy_drives(*each);
    each->run_ticks(200);
  }
  const world::WorldState good = lab.state;
  lab.wrenches = {{lab.model.find_body("lower"), {1e300, -1e300, 1e300}, {1e300, 1e300, 1e300}}};
  EXPECT_FALSE(lab.step().ok);
  lab.wrenches.clear();
  lab.state = good;
  lab.run_ticks(200);
  clean.run_ticks(200);
  EXPECT_EQ(lab.hash(), clean.hash());
}

TEST_P(BadNumbers, AContactThatIsNotFiniteIsRefused) {
  Lab lab(busy_model(GetParam().engine));
  collision::Contact contact{};
  contact.body_a = lab.model.find_body("ball");
  contact.body_b = lab.model.find_body("ground");
  contact.p_W = {0, 0, 0};
  contact.normal_W = {0, 0, kNan};
  const StepResult result =
      lab.engines[0]->step({lab.tick_s(), std::span(&contact, 1), lab.drives, lab.wrenches}, lab.state);
  EXPECT_FALSE(result.ok);
  EXPECT_THAT(result.fault, ::testing::HasSubstr("ball"));
}

TEST_P(BadNumbers, ATickThatIsNoTimeIsRefused) {
  Lab lab(busy_model(GetParam().engine));
  for (const double tick : {0.0, -1e-3, kNan, kInf})
    EXPECT_FALSE(lab.engines[0]->step({tick, lab.contacts, lab.drives, lab.wrenches}, lab.state).ok) << tick;
}

TEST_P(BadNumbers, DrivesForAnotherNumberOfJointsAreRefused) {
  Lab lab(busy_model(GetParam().engine));
  lab.drives.pop_back();
  EXPECT_FALSE(lab.step().ok);
}

}  // namespace
}  // namespace visum::dynamics::testing
