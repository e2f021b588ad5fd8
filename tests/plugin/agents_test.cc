// Agents of scenes: they think on time, command their parts, are part of the state, and harm nobody when they
// fail.
#include <gtest/gtest.h>

#include "tests/plugin/plugged_scene.h"

namespace visum {
namespace {

using test::output_of;
using test::part_of;
using test::run;

constexpr const char* kStepper = R"(
plugins: [kinds]
agents: [{name: hand, kind: stepper, period_ms: 10, parts: {arm: arm}, step: 0.001}]
)";

scene::Scene culprit(const std::string& does) {
  return test::scene_with_arm(
      "plugins: [kinds]\nagents: [{name: hand, kind: culprit, parts: {arm: arm}, does: '" + does + "'}]\n");
}

const std::string& fault_of(cycle::Simulation& simulation, const std::string& part) {
  return *part_of(simulation, part).part->node_fault();
}

TEST(Agent, ThinksOncePerPeriodBeforeThePartsAct) {
  cycle::Simulation simulation(test::scene_with_arm(kStepper));
  run(simulation, 1);
  EXPECT_EQ(output_of(simulation, "hand", "Turns"), 1.0);
  EXPECT_EQ(part_of(simulation, "arm").controller_inputs[0], 0.001);
  run(simulation, 9);
  EXPECT_EQ(output_of(simulation, "hand", "Turns"), 1.0);
  run(simulation, 1);
  EXPECT_EQ(output_of(simulation, "hand", "Turns"), 2.0);
  run(simulation, 989);
  EXPECT_EQ(output_of(simulation, "hand", "Turns"), 100.0);
  EXPECT_NEAR(output_of(simulation, "hand", "Desired"), 0.1, 1e-12);
  EXPECT_GT(output_of(simulation, "arm", "Actual Angle 1"), 0.05);
  EXPECT_EQ(output_of(simulation, "hand", "Node State"), 0.0);
}

TEST(Agent, APeriodNeedNotBeAMultipleOfTheTick) {
  cycle::Simulation simulation(
      test::scene_with_arm("plugins: [kinds]\nagents: [{name: hand, kind: stepper, period_ms: 2.5, parts: "
                           "{arm: arm}, step: 0}]\n"));
  run(simulation, 1000);
  EXPECT_EQ(output_of(simulation, "hand", "Turns"), 400.0);
}

TEST(Agent, IsPartOfSnapshotsAndOfTheHash) {
  cycle::Simulation simulation(test::scene_with_arm(kStepper));
  run(simulation, 55);
  const auto snapshot = simulation.take_snapshot();
  const auto at_snapshot = simulation.state_hash();
  run(simulation, 100);
  const auto later = simulation.state_hash();
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
  EXPECT_EQ(simulation.state_hash(), at_snapshot);
  run(simulation, 100);
  EXPECT_EQ(simulation.state_hash(), later);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), cycle::Simulation(test::scene_with_arm(kStepper)).state_hash());
}

// Faults of the network act between an agent and its parts as they do between a client and its parts.
TEST(Agent, SpeaksAndHearsOverTheSameBrokenNetwork) {
  cycle::Simulation simulation(test::scene_with_arm(kStepper));
  const auto desired = [&] { return part_of(simulation, "arm").controller_inputs[0]; };
  std::string why;
  const auto late = hwparts::make_fault("network_delay", {{"ms", 25}}, why);
  ASSERT_TRUE(late) << why;
  ASSERT_TRUE(simulation.inject({0, *late, 0}).done());
  run(simulation, 25);
  EXPECT_EQ(desired(), 0.0) << "under way";
  run(simulation, 1);
  EXPECT_EQ(desired(), 0.001);
  run(simulation, 10);
  EXPECT_EQ(desired(), 0.002);
  simulation.clear_faults(0, {}, {});
  EXPECT_EQ(desired(), 0.004) << "what was under way has come";
  const auto silent = hwparts::make_fault("part_silent", {}, why);
  ASSERT_TRUE(simulation.inject({0, *silent, 0}).done());
  run(simulation, 100);
  EXPECT_EQ(desired(), 0.004);
}

TEST(Agent, WhatALossyNetworkLetsThroughActsInItsTick) {
  cycle::Simulation simulation(test::scene_with_arm(kStepper));
  std::string why;
  const auto lossy = hwparts::make_fault("network_loss", {{"share", 1e-9}}, why);
  ASSERT_TRUE(lossy) << why;
  ASSERT_TRUE(simulation.inject({0, *lossy, 0}).done());
  run(simulation, 1);
  EXPECT_EQ(part_of(simulation, "arm").controller_inputs[0], 0.001);
}

// As with a client that goes away.
TEST(Agent, WhatIsUnderWayFromOneInFaultComesTooLate) {
  cycle::Simulation simulation(culprit("throws"));
  std::string why;
  const auto late = hwparts::make_fault("network_delay", {{"ms", 25}}, why);
  ASSERT_TRUE(late) << why;
  ASSERT_TRUE(simulation.inject({0, *late, 0}).done());
  run(simulation, 22);
  ASSERT_EQ(fault_of(simulation, "hand"), "lost its head");
  const double before = part_of(simulation, "arm").controller_inputs[0];
  ASSERT_NE(before, 0.5);
  run(simulation, 30);
  EXPECT_EQ(part_of(simulation, "arm").controller_inputs[0], before);
}

TEST(Agent, TheExplorerTakenBackGoesOnWithTheSameBits) {
  const auto file = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/explorer_agent.yaml";
  cycle::Simulation straight(scene::load_scene(file, test::plugin_options()));
  cycle::Simulation rolled(scene::load_scene(file, test::plugin_options()));
  for (int round = 0; round < 4; ++round) {
    run(straight, 500);
    run(rolled, 300);
    const auto snapshot = rolled.take_snapshot();
    run(rolled, 200);
    ASSERT_TRUE(rolled.restore_snapshot(snapshot).done());
    run(rolled, 200);
    ASSERT_EQ(straight.state_hash(), rolled.state_hash()) << "round " << round;
  }
  EXPECT_GT(output_of(straight, "explorer", "Way"), 0.1);
}

struct Misdeed {
  const char* name;
  const char* does;
  const char* fault;
};

class FailingAgent : public testing::TestWithParam<Misdeed> {};

TEST_P(FailingAgent, IsInFaultWithAClearWordAndTheWorldGoesOn) {
  cycle::Simulation simulation(culprit(GetParam().does));
  run(simulation, 15);
  EXPECT_EQ(fault_of(simulation, "hand"), "");
  EXPECT_EQ(output_of(simulation, "hand", "Node State"), 0.0);
  run(simulation, 30);
  EXPECT_EQ(fault_of(simulation, "hand"), GetParam().fault);
  EXPECT_EQ(output_of(simulation, "hand", "Node State"), 1.0);
  EXPECT_EQ(output_of(simulation, "hand", "Turns"), 3.0);
  EXPECT_FALSE(simulation.frozen());
  EXPECT_EQ(simulation.tick_count(), 45);
  EXPECT_EQ(part_of(simulation, "arm").controller_inputs[0], 0.5);  // the last good command
  EXPECT_GE(output_of(simulation, "arm", "Part State"), 2.0);       // its drives have lost their controller
  simulation.reset();
  EXPECT_EQ(fault_of(simulation, "hand"), "");
}

INSTANTIATE_TEST_SUITE_P(
    Misdeeds, FailingAgent,
    testing::Values(
        Misdeed{"Throws", "throws", "lost its head"},
        Misdeed{"ThrowsAnInt", "throws an int", "threw something that is no std::exception"},
        Misdeed{"SetsNotANumber", "sets not a number",
                "part 'arm': 'Desired Angle 1' must be a number from -9.417 to 9.417, is nan"},
        Misdeed{"SetsTooMuch", "sets too much",
                "part 'arm': 'Desired Angle 1' must be a number from -9.417 to 9.417, is 1e+09"},
        Misdeed{"SetsAnUnknownPort", "sets an unknown port", "part 'arm' has no input number 999, it has 22"},
        Misdeed{"AsksForAnUnknownName", "asks for an unknown name",
                "part 'arm': there is no input 'Desired Angel 1'; did you mean 'Desired Angle 1'?"},
        Misdeed{"ReadsAnUnknownPort", "reads an unknown port",
                "part 'arm' has no output number 999, it has 38"}),
    [](const auto& info) { return info.param.name; });

TEST(Agent, WhatCannotBeSavedIsInFaultOnceItIsTakenBack) {
  cycle::Simulation simulation(culprit("cannot save"));
  run(simulation, 5);
  const auto snapshot = simulation.take_snapshot();
  run(simulation, 5);
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
  EXPECT_EQ(fault_of(simulation, "hand"), "save: has no paper");
  run(simulation, 20);
  EXPECT_FALSE(simulation.frozen());
}

TEST(Agent, WhatIsWatchedCannotBeCommanded) {
  cycle::Simulation simulation(
      test::scene_with_arm("plugins: [kinds]\nagents: [{name: eye, kind: watcher, parts: {arm: arm}}]\n"));
  run(simulation, 1);
  EXPECT_EQ(fault_of(simulation, "eye"), "part 'arm' is watched, not commanded");
}

TEST(Agent, AFaultIsPartOfTheState) {
  cycle::Simulation simulation(culprit("throws"));
  run(simulation, 40);
  const auto snapshot = simulation.take_snapshot();
  const auto hash = simulation.state_hash();
  simulation.reset();
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
  EXPECT_EQ(simulation.state_hash(), hash);
  EXPECT_EQ(fault_of(simulation, "hand"), "lost its head");
}

}  // namespace
}  // namespace visum
