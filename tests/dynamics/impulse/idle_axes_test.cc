// Idle axes cost nothing, and come and go from tick to tick. A tick has the same bits whether they were idle
// before or not.
#include <gtest/gtest.h>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::dynamics::impulse {
namespace {

// Driven for three ticks, left alone for three, each joint at its own time; one of them has a feedforward
// only.
void give(dynamics::testing::Lab& lab) {
  for (std::size_t i = 0; i < lab.drives.size(); ++i) {
    const bool is_driven = (lab.state.tick + static_cast<std::int64_t>(i)) % 6 < 3;
    lab.drives[i] = {};
    if (is_driven && i == 2) lab.drives[i].feedforward = 0.5;
    if (is_driven && i != 2) lab.drives[i] = {0.3, 0.01, 5.0, 0.0};
  }
}

class IdleAxes : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Solvers, IdleAxes, ::testing::Values("impulse", "impulse-order4", "impulse-iterate"),
                         [](const auto& row) {
                           std::string name = row.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(IdleAxes, LeaveNothingBehindForTheNextTick) {
  const auto model = physics::arm7(physics::engine_row(GetParam()).setting, 1e-3);
  dynamics::testing::Lab lab(model);
  for (int tick = 0; tick < 40; ++tick) {
    dynamics::testing::Lab fresh(model);
    fresh.state = lab.state;
    give(fresh);
    give(lab);
    ASSERT_TRUE(fresh.step().ok);
    ASSERT_TRUE(lab.step().ok);
    ASSERT_EQ(fresh.hash(), lab.hash()) << "tick " << tick;
    for (std::size_t i = 0; i < lab.drives.size(); ++i)
      if (lab.drives[i].max_effort == 0.0) {
        EXPECT_EQ(lab.state.joints[i].effort, lab.drives[i].feedforward);
      }
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
