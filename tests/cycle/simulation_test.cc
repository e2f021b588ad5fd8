#include "server/cycle/simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hwparts/powercube/module_bus.h"
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

// Counts the warnings in 50 ticks in which two rods fall from level. `settings`: lines of the scene.
std::uint64_t warnings_of_falling_rods(const std::string& settings) {
  const test::TempFiles files;
  Simulation simulation(scene::load_scene(files.write("two_rods.yaml", "visum: 1\n" + settings + R"(
bodies:
  - {name: upper, mass: 1, pose: {xyz: [0.5, 0, 2]}, shapes: [{box: [1, 0.1, 0.1]}]}
  - {name: lower, mass: 1, pose: {xyz: [1.5, 0, 2]}, shapes: [{box: [1, 0.1, 0.1]}]}
joints:
  - {name: shoulder, type: hinge, child: upper, pose: {xyz: [-0.5, 0, 0]}, axis: [0, 1, 0]}
  - {name: elbow, type: hinge, parent: upper, child: lower, pose: {xyz: [-0.5, 0, 0]}, axis: [0, 1, 0]}
)")));
  run(simulation, 50);
  EXPECT_EQ(simulation.fault(), "");
  return simulation.solver_warnings();
}

TEST(Simulation, CountsTheTicksInWhichABudgetWasNotEnough) {
  EXPECT_EQ(warnings_of_falling_rods("engine: {kind: impulse, solver: iterate, d_max: 1e-9, budget: 1}"),
            50u);
  EXPECT_EQ(warnings_of_falling_rods("engine: {kind: impulse, solver: iterate, d_max: 1e-9, budget: 10000}"),
            0u);
}

TEST(Simulation, CountsTheTicksWhoseWorkMetALimitAndNamesBodies) {
  const test::TempFiles files;
  const auto load = [&](const std::string& limit) {
    return scene::load_scene(files.write("pile.yaml", "visum: 1\nengine: {kind: impulse" + limit + R"(}
collision: {work_limit: 1000}
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: low, mass: 1, pose: {xyz: [0, 0, 0.04]}, shapes: [{box: [0.1, 0.1, 0.1]}]}
  - {name: high, mass: 1, pose: {xyz: [0.02, 0, 0.1]}, shapes: [{box: [0.1, 0.1, 0.1]}]}
  - {name: far, mass: 1, pose: {xyz: [9, 0, 9]}, shapes: [{box: [0.1, 0.1, 0.1]}]}
)"));
  };
  Simulation limited(load(", work_limit: 1")), free(load(""));
  run(limited, 50);
  run(free, 50);
  EXPECT_EQ(limited.fault(), "");
  EXPECT_EQ(limited.limited_ticks(), 50u);
  EXPECT_EQ(limited.solver_warnings(), 50u);
  for (const std::string& name : limited.limited_bodies())
    EXPECT_TRUE(name == "low" || name == "high") << name;
  EXPECT_EQ(free.limited_ticks(), 0u);
  EXPECT_TRUE(free.limited_bodies().empty());
}

TEST(Simulation, CountsTheTicksThatWereCutInHalves) {
  EXPECT_GT(warnings_of_falling_rods("engine: impulse\ntick_ms: 100"), 0u);  // too long for their second turn
  EXPECT_EQ(warnings_of_falling_rods("engine: impulse\ntick_ms: 1"), 0u);
}

TEST(Simulation, AJointThatCannotBeHeldStopsTheWorldWithItsNameAndItsLastGoodState) {
  const test::TempFiles files;
  auto scene = scene::load_scene(files.write("bar.yaml", R"(
visum: 1
engine: impulse
bodies:
  - {name: bar, mass: 1, pose: {xyz: [0, 0, 2]}, shapes: [{box: [1, 0.1, 0.1]}]}
joints:
  - {name: left, type: ball, child: bar, pose: {xyz: [-0.5, 0, 0]}}
  - {name: right, type: ball, child: bar, pose: {xyz: [0.5, 0, 0]}}
)"));
  scene.world.joints.at(1).X_PJ.p.x() += 0.2;  // farther from the left one than the bar is long
  Simulation simulation(std::move(scene));
  const auto before = simulation.state_hash();
  run(simulation, 3);
  EXPECT_TRUE(simulation.frozen());
  EXPECT_NE(simulation.fault().find("on body 'bar' cannot be held together"), std::string::npos)
      << simulation.fault();
  EXPECT_EQ(simulation.tick_count(), 0);
  EXPECT_EQ(simulation.state_hash(), before);
}

TEST(Simulation, TwoRunsHaveTheSameHashAtEveryTick) {
  Simulation a(arm()), b(arm());
  for (int i = 0; i < 300; ++i) {
    a.tick();
    b.tick();
    ASSERT_EQ(a.state_hash(), b.state_hash()) << "tick " << i;
  }
}

// A write and a telegram between the same two ticks count in their order.
TEST(Simulation, OfAWriteAndATelegramTheLaterOneMovesTheDrive) {
  const powercube::Telegram ramp{
      powercube::Telegram::Kind::kSet, 1, {0x0B, 0x04, 0xCD, 0xCC, 0xCC, 0x3D}};  // to 0.1 rad
  for (const bool bus_last : {true, false}) {
    Simulation simulation(arm());
    simulation.tick();
    if (!bus_last) simulation.handle_telegram(0, ramp, powercube::BusFraming::kSerial);
    simulation.write_inputs(0, 0, std::vector{0.3});
    if (bus_last) simulation.handle_telegram(0, ramp, powercube::BusFraming::kSerial);
    run(simulation, 2500);
    EXPECT_NEAR(simulation.state().joints[0].position, bus_last ? 0.1 : 0.3, 5e-3);
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
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
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
    ASSERT_TRUE(rolled.restore_snapshot(snapshot).done());
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

// True if any joint or body of the arm has a peak above zero, over all ticks up to now.
bool has_peaks(const Simulation& simulation) {
  std::vector<double> errors(simulation.model().joints.size()), forces(simulation.model().bodies.size());
  simulation.ring()->peaks(0, simulation.tick_count(), errors, forces);
  const auto any = [](const auto& numbers) {
    return std::ranges::any_of(numbers, [](double x) { return x > 0; });
  };
  return any(errors) || any(forces);
}

std::vector<double> errors_of(const Simulation& simulation) {
  const auto errors = simulation.following_errors();
  return {errors.begin(), errors.end()};
}

TEST(Simulation, NothingOfTheTicksBeforeAResetIsShown) {
  Simulation simulation(arm());
  const auto first = errors_of(simulation);
  simulation.write_inputs(0, 0, std::vector{1.0});
  run(simulation, 100);
  ASSERT_NE(errors_of(simulation), first);
  ASSERT_TRUE(has_peaks(simulation));
  simulation.reset();
  EXPECT_EQ(errors_of(simulation), first);
  EXPECT_FALSE(has_peaks(simulation));
}

TEST(Simulation, ARestoredWorldHasItsFollowingErrorsAndNoPeaks) {
  Simulation simulation(arm());
  simulation.write_inputs(0, 0, std::vector{1.0});
  run(simulation, 100);
  const auto snapshot = simulation.take_snapshot();
  const auto errors = errors_of(simulation);
  run(simulation, 50);
  ASSERT_NE(errors_of(simulation), errors);
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
  EXPECT_EQ(errors_of(simulation), errors);
  EXPECT_FALSE(has_peaks(simulation));
  run(simulation, 1);
  EXPECT_TRUE(has_peaks(simulation));
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
  EXPECT_EQ(simulation.restore_snapshot(first).refusal(), Refusal::kUnknownName);
  EXPECT_TRUE(simulation.restore_snapshot(first + 1).done());
}

TEST(Simulation, APushActsForItsTicksAndNoLonger) {
  auto scene = falling_box();
  scene.world.gravity.setZero();
  Simulation simulation(scene);
  const auto box = simulation.model().find_body("box");
  ASSERT_TRUE(simulation.push({{box, {2.0, 0, 0}, {0, 0, 0}}, 50}).done());
  run(simulation, 200);
  EXPECT_NEAR(simulation.state().bodies[box.index()].v_WC.x(), 2.0 * 0.05, 1e-9) << "impulse over mass";
}

TEST(Simulation, RefusesMorePushesThanItHolds) {
  Simulation simulation(falling_box());
  const Push push{{simulation.model().find_body("box"), {1, 0, 0}, {0, 0, 0}}, 10};
  for (std::size_t i = 0; i < Simulation::kMaxPushes; ++i) EXPECT_TRUE(simulation.push(push).done());
  EXPECT_EQ(simulation.push(push).refusal(), Refusal::kFull);
  run(simulation, 11);
  EXPECT_TRUE(simulation.push(push).done()) << "those that ended made room";
}

TEST(Simulation, BodiesComeAndGo) {
  Simulation simulation(falling_box());
  run(simulation, 100);
  const double before = height(simulation, "box");
  EXPECT_TRUE(
      simulation.add_body("{name: ball, mass: 0.5, pose: {xyz: [1, 0, 2]}, shapes: [{sphere: 0.1}]}").done());
  EXPECT_EQ(simulation.revision(), 2u);
  EXPECT_EQ(height(simulation, "box"), before) << "the others stay where they are";
  run(simulation, 100);
  EXPECT_NEAR(height(simulation, "ball"), 2.0 - 0.5 * 9.81 * 0.01, 2e-3);
  EXPECT_EQ(simulation.remove_body("box").text(), "");
  EXPECT_FALSE(simulation.model().find_body("box").valid());
  run(simulation, 100);
  EXPECT_FALSE(simulation.frozen());
  const auto again = simulation.remove_body("box");
  EXPECT_EQ(again.refusal(), Refusal::kUnknownName);
  EXPECT_EQ(again.text(), "there is no body 'box'; there are: floor, ball");
}

TEST(Simulation, PeaksOutliveBodiesThatComeAndGo) {
  Simulation simulation(falling_box());
  run(simulation, 450);
  const auto peak_of_box = [&] {
    std::vector<double> forces(simulation.model().bodies.size());
    simulation.ring()->peaks(0, simulation.tick_count(), {}, forces);
    return forces.at(simulation.model().find_body("box").index());
  };
  const double before = peak_of_box();
  ASSERT_GT(before, 10.0 * 9.81) << "it has hit the floor";
  EXPECT_TRUE(
      simulation.add_body("{name: ball, mass: 0.5, pose: {xyz: [1, 0, 2]}, shapes: [{sphere: 0.1}]}").done());
  EXPECT_EQ(peak_of_box(), before);
  ASSERT_EQ(simulation.remove_body("ball").text(), "");
  EXPECT_EQ(peak_of_box(), before);
}

TEST(Simulation, ABodyMayGoOnceItsPushIsOver) {
  Simulation simulation(falling_box());
  ASSERT_TRUE(simulation.push({{simulation.model().find_body("box"), {1, 0, 0}, {0, 0, 0}}, 1}).done());
  const auto refused = simulation.remove_body("box");
  EXPECT_EQ(refused.refusal(), Refusal::kWrongState);
  EXPECT_EQ(refused.text(), "'box' is being pushed");
  run(simulation, 1);
  EXPECT_EQ(simulation.remove_body("box").text(), "");
  const auto hash = simulation.state_hash();
  recording::State whole;
  simulation.keep(whole);
  EXPECT_EQ(simulation.restore(whole).text(), "") << "nothing is left of the push";
  EXPECT_EQ(simulation.state_hash(), hash);
}

TEST(Simulation, ABadBodyChangesNothing) {
  Simulation simulation(falling_box());
  const auto before = simulation.state_hash();
  for (const char* body :
       {"{name: ball, mass: -1, shapes: [{sphere: 0.1}]}", "{name: box, mass: 1, shapes: [{sphere: 0.1}]}"}) {
    const auto outcome = simulation.add_body(body);
    EXPECT_EQ(outcome.refusal(), Refusal::kBadValue) << body;
    EXPECT_NE(outcome.text(), "") << body;
  }
  EXPECT_EQ(simulation.state_hash(), before);
  EXPECT_EQ(simulation.revision(), 1u);
}

// A snapshot may come from a file.
TEST(Simulation, ASnapshotThatHoldsNonsenseChangesNothing) {
  Simulation simulation(falling_box());
  run(simulation, 20);
  const auto snapshot = simulation.take_snapshot();
  recording::State whole;
  simulation.keep(whole);
  whole.snapshots.at(0).state.pop_back();
  ASSERT_EQ(simulation.restore(whole).text(), "");
  run(simulation, 30);
  const auto before = simulation.state_hash();
  const auto damaged = simulation.restore_snapshot(snapshot);
  EXPECT_EQ(damaged.refusal(), Refusal::kDamaged);
  EXPECT_EQ(damaged.text(), "the snapshot's state is shorter than the part's");
  EXPECT_EQ(simulation.state_hash(), before);
  EXPECT_EQ(simulation.era(), 1u);
  run(simulation, 10);
  EXPECT_EQ(simulation.tick_count(), 60);
  const auto unknown = simulation.restore_snapshot(99);
  EXPECT_EQ(unknown.refusal(), Refusal::kUnknownName);
  EXPECT_EQ(unknown.text(), "there is no snapshot 99");
}

// The scene takes the body, but the camera that would see it cannot read the picture on it.
TEST(Simulation, ABodyThatASensorCannotBearChangesNothing) {
  const test::TempFiles files;
  files.write("bad.png", "\x89PNG\r\n\x1a\nnothing more");
  Simulation simulation(scene::load_scene(files.write("s.yaml", R"(
visum: 1
clock: free
materials: {picture: {texture: bad.png}}
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: ball, mass: 1, pose: {xyz: [0, 0, 1]}, shapes: [{sphere: 0.1}]}
sensors:
  - {name: eye, kind: camera, size: [8, 8], fov_deg: 60}
  - {name: place, kind: pose, body: ball}
)")));
  run(simulation, 20);
  const auto before = simulation.state_hash();
  const auto snapshot = simulation.take_snapshot();
  const std::string box = "{name: box, mass: 1, pose: {xyz: [3, 0, 1]}, shapes: [{box: [1, 1, 1]}]";
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(simulation.add_body(box + ", material: picture}").refusal(), Refusal::kBadValue);
  EXPECT_EQ(simulation.state_hash(), before);
  EXPECT_EQ(simulation.revision(), 1u);
  EXPECT_EQ(simulation.model().bodies.size(), 2u);
  run(simulation, 20);
  EXPECT_TRUE(simulation.restore_snapshot(snapshot).done());
  EXPECT_EQ(simulation.state_hash(), before);
  EXPECT_TRUE(simulation.add_body(box + "}").done());
  run(simulation, 20);
  EXPECT_FALSE(simulation.frozen()) << simulation.fault();
  EXPECT_EQ(simulation.state().bodies.size(), 3u);
}

TEST(Simulation, BodiesThatComeAndGoLeaveNothingBehind) {
  const test::TempFiles files;
  files.write("wedge.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  Simulation simulation(scene::load_scene(files.write("s.yaml", R"(
visum: 1
engine: ode
bodies: [{name: floor, fixed: true, shapes: [{plane: true}]}, {name: box, mass: 1, pose: {xyz: [0, 0, 1]}, shapes: [{sphere: 0.1}]}]
)")));
  const std::string wedge = "{name: wedge, mass: 1, pose: {xyz: [3, 0, 1]}, shapes: [{convex: wedge.obj}]}";
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(simulation.add_body(wedge).done());
    EXPECT_EQ(simulation.model().meshes.size(), 1u);
    ASSERT_EQ(simulation.remove_body("wedge").text(), "");
  }
  EXPECT_TRUE(simulation.model().meshes.empty());
  recording::State whole;
  simulation.keep(whole);
  EXPECT_TRUE(whole.edits.empty());
  // A body of the scene itself that was removed must be removed again in a restored world.
  ASSERT_EQ(simulation.remove_body("box").text(), "");
  EXPECT_TRUE(
      simulation.add_body("{name: box, mass: 2, pose: {xyz: [0, 0, 1]}, shapes: [{sphere: 0.1}]}").done());
  EXPECT_TRUE(simulation.add_body(wedge).done());
  ASSERT_EQ(simulation.remove_body("box").text(), "");
  simulation.keep(whole);
  using Edit = recording::State::Edit;
  EXPECT_EQ(whole.edits, (std::vector<Edit>{{Edit::Kind::kBodyWent, "box", nullptr},
                                            {Edit::Kind::kBodyCame, wedge, nullptr}}));
  const auto before = simulation.state_hash();
  EXPECT_TRUE(simulation.add_body("{name: other, mass: 1, shapes: [{sphere: 0.1}]}").done());
  ASSERT_EQ(simulation.restore(whole).text(), "");
  EXPECT_EQ(simulation.state_hash(), before);
}

// If contacts beyond the limit were dropped, bodies would fall through the floor.
TEST(Simulation, MoreContactsThanAreFoundFreezeTheWorld) {
  const test::TempFiles files;
  Simulation simulation(scene::load_scene(files.write("s.yaml", R"(
visum: 1
engine: ode
bodies:
  - {name: "box_${i}", repeat: {i: 150}, mass: 1, pose: {xyz: ["${i * 0.001}", "${i * 0.002}", 1]}, shapes: [{box: [1, 1, 1]}]}
)")));
  run(simulation, 3);
  ASSERT_TRUE(simulation.frozen());
  EXPECT_EQ(simulation.fault().find("more than 20000 contacts in one tick: the last is between 'box_"), 0u)
      << simulation.fault();
  EXPECT_EQ(simulation.tick_count(), 0);
}

TEST(Simulation, AnExplosionFreezesTheWorldAtItsLastGoodState) {
  Simulation simulation(falling_box());
  run(simulation, 10);
  const auto box = simulation.model().find_body("box");
  ASSERT_TRUE(simulation.push({{box, {1e12, 0, 0}, {0, 0, 0}}, 100}).done());
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
