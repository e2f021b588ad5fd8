// Finds state that snapshots forget: after every tick the world goes back by seven ticks, gets the same
// inputs again, and must come to the same bits (GGPO's SyncTest). Longer, by hand:
//   VISUM_SYNC_TICKS=100000 build/release/bin/cycle_test --gtest_filter='*Sync*'
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <deque>

#include "server/cycle/simulation.h"

namespace visum::cycle {
namespace {

constexpr int kBack = 7;

int ticks_to_go() {
  const char* wanted = std::getenv("VISUM_SYNC_TICKS");
  return wanted ? std::atoi(wanted) : 100;
}

// Moves the first two inputs of every part a little from tick to tick.
void write_inputs(Simulation& simulation, std::int64_t tick) {
  const auto parts = std::as_const(simulation).parts();
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (parts[part].controller_inputs.size() < 2) continue;
    const double angle = 0.3 * std::sin(0.004 * static_cast<double>(tick));
    simulation.write_inputs(part, 0, std::vector{angle, -0.5 * angle});
  }
}

void tick(Simulation& simulation) {
  write_inputs(simulation, simulation.tick_count());
  simulation.tick();
}

struct World {
  const char* name;
  const char* scene;
  const char* engine;
};
void PrintTo(const World& world, std::ostream* out) {
  *out << world.name;
}
class Sync : public testing::TestWithParam<World> {};

TEST_P(Sync, SevenTicksBackAndAgainAreTheSameBits) {
  const auto file = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes" / GetParam().scene;
  Simulation simulation(scene::load_scene(file, {GetParam().engine}));
  std::deque<std::uint64_t> snapshots;  // of the last ticks
  for (int i = 0, all = ticks_to_go(); i < all; ++i) {
    snapshots.push_back(simulation.take_snapshot());
    tick(simulation);
    if (snapshots.size() < kBack) continue;
    const auto hash = simulation.state_hash();
    ASSERT_TRUE(simulation.restore_snapshot(snapshots.front()).done());
    snapshots.pop_front();
    for (int k = 0; k < kBack; ++k) tick(simulation);
    ASSERT_EQ(simulation.state_hash(), hash) << "at tick " << simulation.tick_count();
  }
  EXPECT_FALSE(simulation.frozen()) << simulation.fault();
}

INSTANTIATE_TEST_SUITE_P(All, Sync,
                         testing::Values(World{"ArmOde", "amtec_arm.yaml", "ode"},
                                         World{"ArmImpulse", "amtec_arm.yaml", "impulse"},
                                         World{"CartOde", "cart.yaml", "ode"},
                                         World{"CrawlerImpulse", "crawler.yaml", "impulse"},
                                         World{"Sensors", "sensors.yaml", ""}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace visum::cycle
