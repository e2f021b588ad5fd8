#include "server/cycle/simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/config/config.h"
#include "tests/support/temp_files.h"

namespace visum::cycle {
namespace {

// A box that falls onto a floor, from a scene file of the test's own.
scene::Scene falling_box() {
  const test::TempFiles files;
  return scene::load_scene(files.write("falling_box.yaml", R"(
visum: 1
name: falling_box
engine: ode
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: box, mass: 1.0, pose: {xyz: [0, 0, 1.0]}, shapes: [{box: [0.2, 0.2, 0.2]}]}
)"));
}

scene::Scene arm() {
  return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
}

void run(Simulation& simulation, int ticks) {
  for (int i = 0; i < ticks; ++i) simulation.tick();
}

double height(const Simulation& simulation, const char* body) {
  return simulation.state().bodies[simulation.model().find_body(body).index()].p_WC.z();
}

TEST(Simulation, ABoxFallsAndComesToRestWithItsWeightOnTheFloor) {
  Simulation simulation(falling_box());
  run(simulation, 300);
  EXPECT_NEAR(height(simulation, "box"), 1.0 - 0.5 * 9.81 * 0.3 * 0.3, 5e-3);
  run(simulation, 1700);
  EXPECT_NEAR(height(simulation, "box"), 0.1, 1e-3);
  double weight = 0.0;
  for (const auto& contact : simulation.contacts()) weight += contact.normal_force_n;
  EXPECT_NEAR(weight, 9.81, 0.1);
  EXPECT_EQ(simulation.sim_time_ns(), 2'000'000'000);
}

TEST(Simulation, TwoRunsHaveTheSameHashAtEveryTick) {
  Simulation a(arm()), b(arm());
  for (int i = 0; i < 300; ++i) {
    a.tick();
    b.tick();
    ASSERT_EQ(a.state_hash(), b.state_hash()) << "tick " << i;
  }
}

TEST(Simulation, ASnapshotGoesOnWithTheSameBits) {
  Simulation simulation(arm());
  simulation.write_inputs(0, 0, std::vector{0.3, 0.4});
  run(simulation, 150);
  const auto snapshot = simulation.take_snapshot();
  const auto at_snapshot = simulation.state_hash();
  run(simulation, 400);
  const auto later = simulation.state_hash();
  ASSERT_TRUE(simulation.restore_snapshot(snapshot));
  EXPECT_EQ(simulation.state_hash(), at_snapshot);
  EXPECT_EQ(simulation.tick_count(), 150);
  EXPECT_EQ(simulation.era(), 2u);
  run(simulation, 400);
  EXPECT_EQ(simulation.state_hash(), later);
}

// Every 11 ticks: back by 7, forward again, same bits (GGPO's SyncTest).
TEST(Simulation, RollingBackSevenTicksChangesNothing) {
  Simulation straight(arm()), rolled(arm());
  const std::vector targets{0.4, 0.3, -0.2, 0.5, 0.1, -0.3, 0.2};
  straight.write_inputs(0, 0, targets);
  rolled.write_inputs(0, 0, targets);
  for (int round = 0; round < 60; ++round) {
    run(straight, 11);
    run(rolled, 4);
    const auto snapshot = rolled.take_snapshot();
    run(rolled, 7);
    ASSERT_TRUE(rolled.restore_snapshot(snapshot));
    run(rolled, 7);
    ASSERT_EQ(straight.state_hash(), rolled.state_hash()) << "round " << round;
  }
}

TEST(Simulation, ResetGoesBackToTheSameFirstBits) {
  Simulation simulation(arm());
  const auto first = simulation.state_hash();
  simulation.write_inputs(0, 0, std::vector{1.0});
  run(simulation, 100);
  EXPECT_NE(simulation.state_hash(), first);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), first);
  EXPECT_EQ(simulation.era(), 2u);
  EXPECT_EQ(simulation.tick_count(), 0);
}

TEST(Simulation, TheSeedIsPartOfTheState) {
  auto scene = falling_box();
  const auto one = Simulation(scene).state_hash();
  scene.seed += 1;
  EXPECT_NE(Simulation(scene).state_hash(), one);
}

TEST(Simulation, ThrowsTheOldestSnapshotAwayBeyondTheLimit) {
  Simulation simulation(falling_box());
  const auto first = simulation.take_snapshot();
  for (std::size_t i = 0; i < Simulation::kMaxSnapshots; ++i) simulation.take_snapshot();
  EXPECT_FALSE(simulation.restore_snapshot(first));
  EXPECT_TRUE(simulation.restore_snapshot(first + 1));
}

TEST(Simulation, APushActsForItsTicksAndNoLonger) {
  auto scene = falling_box();
  scene.world.gravity.setZero();
  Simulation simulation(scene);
  const auto box = simulation.model().find_body("box");
  ASSERT_TRUE(simulation.push({{box, {2.0, 0, 0}, {0, 0, 0}}, 50}));
  run(simulation, 200);
  EXPECT_NEAR(simulation.state().bodies[box.index()].v_WC.x(), 2.0 * 0.05, 1e-9) << "impulse over mass";
}

TEST(Simulation, RefusesMorePushesThanItHolds) {
  Simulation simulation(falling_box());
  const Push push{{simulation.model().find_body("box"), {1, 0, 0}, {0, 0, 0}}, 10};
  for (std::size_t i = 0; i < Simulation::kMaxPushes; ++i) EXPECT_TRUE(simulation.push(push));
  EXPECT_FALSE(simulation.push(push));
  run(simulation, 11);
  EXPECT_TRUE(simulation.push(push)) << "those that ended made room";
}

TEST(Simulation, BodiesComeAndGo) {
  Simulation simulation(falling_box());
  run(simulation, 100);
  const double before = height(simulation, "box");
  simulation.add_body("{name: ball, mass: 0.5, pose: {xyz: [1, 0, 2]}, shapes: [{sphere: 0.1}]}");
  EXPECT_EQ(simulation.revision(), 2u);
  EXPECT_EQ(height(simulation, "box"), before) << "the others stay where they are";
  run(simulation, 100);
  EXPECT_NEAR(height(simulation, "ball"), 2.0 - 0.5 * 9.81 * 0.01, 2e-3);
  EXPECT_EQ(simulation.remove_body("box"), "");
  EXPECT_FALSE(simulation.model().find_body("box").valid());
  run(simulation, 100);
  EXPECT_FALSE(simulation.frozen());
  EXPECT_EQ(simulation.remove_body("box"), "there is no body 'box'");
}

TEST(Simulation, ABadBodyChangesNothing) {
  Simulation simulation(falling_box());
  const auto before = simulation.state_hash();
  EXPECT_THROW(simulation.add_body("{name: ball, mass: -1, shapes: [{sphere: 0.1}]}"), config::ConfigError);
  EXPECT_THROW(simulation.add_body("{name: box, mass: 1, shapes: [{sphere: 0.1}]}"), config::ConfigError);
  EXPECT_EQ(simulation.state_hash(), before);
  EXPECT_EQ(simulation.revision(), 1u);
}

TEST(Simulation, AnExplosionFreezesTheWorldAtItsLastGoodState) {
  Simulation simulation(falling_box());
  run(simulation, 10);
  const auto box = simulation.model().find_body("box");
  ASSERT_TRUE(simulation.push({{box, {1e12, 0, 0}, {0, 0, 0}}, 100}));
  run(simulation, 50);
  ASSERT_TRUE(simulation.frozen());
  EXPECT_NE(simulation.fault().find("box"), std::string::npos) << simulation.fault();
  EXPECT_EQ(simulation.tick_count(), 10);
  EXPECT_TRUE(std::isfinite(height(simulation, "box")));
  simulation.reset();
  EXPECT_FALSE(simulation.frozen());
  run(simulation, 10);
  EXPECT_EQ(simulation.tick_count(), 10);
}

}  // namespace
}  // namespace visum::cycle
