// `solver: iterate` over the whole grid of its settings: ticks of 1 to 50 ms, budgets from 1, bounds of gaps
// from 1e-6 to 1e-2 m. Linked bodies must stay together and gain no energy, however few corrections they get;
// where the bounds are missed, the tick says so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::dynamics::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Setting {
  double tick_s = 1e-3, d_max = 1e-6;
  int budget = 100;
};

world::EngineSetting engine_of(const Setting& at) {
  world::EngineSetting setting;
  setting.name = "impulse";
  setting.solver = "iterate";
  setting.budget = at.budget;
  setting.d_max = at.d_max;
  return setting;
}

// Thin bars of 1 m on hinges about y, stretched out sideways. The last one weighs `tip_kg`.
world::WorldModel bars(const Setting& at, int count, double tip_kg) {
  std::vector<physics::Link> links;
  for (int i = 0; i < count; ++i) {
    const double mass = i + 1 == count ? tip_kg : 1.0;
    links.push_back({{0.0, 0.0, i == 0 ? 0.0 : -1.0},
                     Eigen::Vector3d::UnitY(),
                     mass,
                     {0.0, 0.0, -0.5},
                     physics::solid_cylinder_inertia(mass, 0.02, 1.0),
                     i == 0 ? 90.0 * kDegree : 0.0});
  }
  return physics::serial_model(engine_of(at), at.tick_s, links);
}

struct Seen {
  double gap_m = 0.0, gain = 0.0;  // the gain is a share of energy_scale()
  double deepest_m = 0.0;          // place of the last body's centre of mass
  int untold = 0;                  // ticks that ended beyond d_max without a warning
};

// Two seconds, in at most 800 ticks.
Seen watch(world::WorldModel model, const Setting& at) {
  Lab lab(std::move(model));
  const double start = physics::energy_of(lab.model, lab.state), scale = physics::energy_scale(lab.model);
  const int ticks = std::min(800, static_cast<int>(std::lround(2.0 / at.tick_s)));
  Seen seen;
  for (int i = 0; i < ticks; ++i) {
    const int warned = lab.warned_ticks;
    lab.run_ticks(1);
    const double gap = physics::max_gap(lab.model, lab.state);
    seen.gap_m = std::max(seen.gap_m, gap);
    seen.gain = std::max(seen.gain, (physics::energy_of(lab.model, lab.state) - start) / scale);
    seen.deepest_m = std::min(seen.deepest_m, lab.state.bodies.back().p_WC.z());
    // d_max bounds the gap; its figure here is a norm.
    if (gap > 2.0 * at.d_max && lab.warned_ticks == warned) ++seen.untold;
  }
  return seen;
}

void expect_together(const std::function<world::WorldModel(const Setting&)>& model, double deepest_m) {
  for (const double tick_s : {1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05})
    for (const double d_max : {1e-6, 1e-4, 1e-2})
      for (const int budget : {1, 3, 10, 100}) {
        const Setting at{tick_s, d_max, budget};
        SCOPED_TRACE(::testing::Message()
                     << "tick " << tick_s << " s, d_max " << d_max << ", budget " << budget);
        const Seen seen = watch(model(at), at);
        EXPECT_LT(seen.gap_m, 0.05);
        EXPECT_LT(seen.gain, 1e-3);
        EXPECT_LT(seen.deepest_m, deepest_m) << "they move on";
        EXPECT_EQ(seen.untold, 0);
      }
}

TEST(IterateGrid, HingedBarsStayTogetherAndGainNoEnergy) {
  expect_together([](const Setting& at) { return bars(at, 3, 1.0); }, -2.0);
}

TEST(IterateGrid, BarsWithATipOfAHundredTimesTheirMassDoToo) {
  expect_together([](const Setting& at) { return bars(at, 3, 100.0); }, -0.2);
}

TEST(IterateGrid, ALoopDoesToo) {
  expect_together([](const Setting& at) { return physics::four_bars(engine_of(at), at.tick_s, 2); }, -0.3);
}

// The setting of the first report: the first bar was found 42 km from its pivot.
TEST(IterateGrid, BarsAtDefaultSettingsAndTicksOf20MsHangOnTheirPivot) {
  Setting at;
  at.tick_s = 0.02;
  at.d_max = 0.0;
  Lab lab(bars(at, 3, 1.0));
  for (int i = 0; i < 500; ++i) {
    lab.run_ticks(1);
    ASSERT_LT(physics::max_gap(lab.model, lab.state), 0.05) << i;
  }
}

// The state holds all that a firm step leaves behind: going on from a copy gives the same bits.
TEST(IterateGrid, ARestoredWorldGoesOnWithTheSameBits) {
  const Setting at{0.02, 1e-4, 3};
  Lab lab(bars(at, 3, 100.0)), again(bars(at, 3, 100.0));
  lab.run_ticks(40);
  again.state = lab.state;
  for (Lab* one : {&lab, &again}) one->run_ticks(40);
  EXPECT_EQ(lab.hash(), again.hash());
}

}  // namespace
}  // namespace visum::dynamics::testing
