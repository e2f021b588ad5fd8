// A warm tick of the engine `impulse` and of the collision stage allocates nothing. Warm means that the same
// has happened before, from the same state. Allocations inside FCL are not counted.
#include "tests/support/allocation_counter.h"

#include "tests/dynamics/contract/scenes.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/legged_models.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::dynamics::testing {
namespace {

std::vector<physics::EngineRow> impulse_rows() {
  std::vector<physics::EngineRow> rows = physics::engine_rows();
  std::erase_if(rows, [](const physics::EngineRow& row) { return row.setting.name != "impulse"; });
  return rows;
}

class Allocation : public ::testing::TestWithParam<physics::EngineRow> {
 protected:
  static void expect_none_the_second_time(Lab& lab, int ticks) {
    const world::WorldState start = lab.state;
    lab.run_ticks(ticks);
    const std::uint64_t end = lab.hash();
    lab.state = start;
    test_support::AllocationCounts counts;
    std::string ours;
    {
      const test_support::AllocationScope scope;
      lab.run_ticks(ticks);
      counts = scope.counts();
      ours = scope.describe_ours();
    }
    EXPECT_EQ(counts.ours, 0u) << ours;
    EXPECT_EQ(lab.hash(), end);
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, Allocation, ::testing::ValuesIn(impulse_rows()), [](const auto& info) {
  std::string name = info.param.name;
  std::erase(name, '-');
  return name;
});

TEST_P(Allocation, DrivesFallsAndContactsNeedNoneOfOurs) {
  Lab lab(busy_model(GetParam().setting));
  set_busy_drives(lab);
  expect_none_the_second_time(lab, 800);
  EXPECT_FALSE(lab.contacts.empty());
}

TEST_P(Allocation, ClosedLoopsNeedNone) {
  Lab lab(physics::four_bars(GetParam().setting, 1e-3, 3));
  expect_none_the_second_time(lab, 200);
  Lab standing(physics::standing_linkages(GetParam().setting, 1e-3, 1));
  expect_none_the_second_time(standing, 200);
  EXPECT_FALSE(standing.contacts.empty());
}

// A step whose joints do not close is cut in halves. The solver `iterate` cuts none: it leaves what its
// budget leaves.
TEST_P(Allocation, StepsInHalvesNeedNone) {
  Lab arm(physics::arm7(GetParam().setting, 4e-2)), loops(physics::four_bars(GetParam().setting, 5e-2, 2));
  expect_none_the_second_time(arm, 50);
  expect_none_the_second_time(loops, 20);
  if (GetParam().setting.solver == "direct") {
    EXPECT_GT(arm.warned_ticks, 0) << "the case is no longer the one that is meant";
  }
}

// A ball on a rail hits a plate: the tick of the hit is made twice.
TEST_P(Allocation, ForeseenContactsNeedNone) {
  ModelBuilder b(GetParam().setting);
  b.add_fixed_box("plate", {0.01, 1, 1}, at(0, 0, 0));
  const BodyId ball = b.add_sphere("ball", 0.02, 0.26, at(-0.5, 0, 0));
  b.body(ball).v_WB = {130.0, 0, 0};
  b.add_joint("rail", world::JointKind::kSlider, {}, ball, {-0.5, 0, 0}, {1, 0, 0});
  Lab lab(b.model);
  expect_none_the_second_time(lab, 10);
  EXPECT_LT(lab.body("ball").p_WC.x(), 0.0);
}

// With two threads, those of the tick's own thread are counted. Which islands it makes varies, so it may take
// some rounds until it has seen the largest of each.
TEST(AllocationOfIslands, PilesAndRagdollsNeedNone) {
  for (const int threads : {1, 2}) {
    world::EngineSetting setting = physics::engine_row("impulse").setting;
    setting.threads = threads;
    const auto fall = [&](const world::WorldModel& model, int ticks) {
      const int most_rounds = threads == 1 ? 2 : 20;
      Lab lab(model);
      const world::WorldState start = lab.state;
      test_support::AllocationCounts counts;
      std::string ours;
      for (int round = 0; round < most_rounds && (round < 2 || counts.ours > 0); ++round) {
        lab.state = start;
        const test_support::AllocationScope scope;
        lab.run_ticks(ticks);
        counts = scope.counts();
        ours = scope.describe_ours();
      }
      EXPECT_EQ(counts.ours, 0u) << threads << " threads: " << ours;
    };
    fall(physics::piles(setting, 1e-3, 4, 10), 300);
    fall(physics::falling_ragdolls(setting, 1e-3, 3), 600);
  }
}

}  // namespace
}  // namespace visum::dynamics::testing
