// Engines of plug-ins: what they are given, what they keep, and what happens to a world that they ruin.
#include <gtest/gtest.h>

#include "tests/plugin/plugged_scene.h"

namespace visum {
namespace {

using test::error_of_scene;
using test::run;
using test::scene_of;

// The first body belongs to the plug-in's engine, the second to ODE.
std::string clumsy(const std::string& does) {
  return "plugins: [kinds]\nengines: {own: {kind: clumsy, does: '" + does +
         "'}}\nbodies:\n"
         "  - {name: stone, mass: 1, inertia: [1, 1, 1, 0, 0, 0], engine: own}\n"
         "  - {name: other, mass: 1, inertia: [1, 1, 1, 0, 0, 0], pose: {xyz: [0, 5, 0]}}\n"
         "joints: [{name: hinge, type: hinge, child: stone, axis: [1, 0, 0]}]\n";
}

TEST(PluggedEngine, MovesItsOwnBodiesAndNoOthers) {
  cycle::Simulation simulation(scene_of(clumsy("moves what is not its own")));
  run(simulation, 4);
  EXPECT_DOUBLE_EQ(simulation.state().bodies[0].p_WC.x(), 1e-3 * (1 + 2 + 3 + 4));
  EXPECT_EQ(simulation.state().bodies[0].v_WC.z(), 0.0);
  EXPECT_NEAR(simulation.state().bodies[1].v_WC.z(), -9.81 * 4e-3, 1e-9);
  EXPECT_LT(simulation.state().bodies[1].p_WC.z(), 0.0);
}

TEST(PluggedEngine, WhatItKeepsIsPartOfSnapshotsAndOfTheHash) {
  cycle::Simulation simulation(scene_of(clumsy("")));
  const auto at_start = simulation.state_hash();
  run(simulation, 5);
  const auto snapshot = simulation.take_snapshot();
  run(simulation, 5);
  const auto later = simulation.state_hash();
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
  run(simulation, 5);
  EXPECT_EQ(simulation.state_hash(), later);
  simulation.reset();
  EXPECT_EQ(simulation.state_hash(), at_start);
  run(simulation, 10);
  EXPECT_EQ(simulation.state_hash(), later);
}

TEST(PluggedEngine, MayReplaceTheSceneOwnByOption) {
  cycle::Simulation simulation(
      scene_of("plugins: [kinds]\nbodies: [{name: stone, mass: 1, inertia: [1, 1, 1, 0, 0, 0]}]", "clumsy"));
  run(simulation, 2);
  EXPECT_DOUBLE_EQ(simulation.state().bodies[0].p_WC.x(), 3e-3);
}

// The refusal comes after the other engines were made, and before the collisions and the sensors are.
TEST(PluggedEngine, ThatRefusesAWorldLeavesTheOneThatItHas) {
  cycle::Simulation simulation(scene_of(clumsy("wants two bodies")));
  run(simulation, 5);
  const auto before = simulation.state_hash();
  const auto snapshot = simulation.take_snapshot();
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(simulation.add_body("{name: ball, mass: 1, pose: {xyz: [9, 0, 0]}, shapes: [{sphere: 0.1}]}")
                  .refusal(),
              cycle::Refusal::kBadValue);
  const auto outcome = simulation.remove_body("other");
  EXPECT_EQ(outcome.refusal(), cycle::Refusal::kWrongState);
  EXPECT_NE(outcome.text().find("has two hands"), std::string::npos);
  EXPECT_EQ(simulation.model().bodies.size(), 2u);
  EXPECT_EQ(simulation.revision(), 1u);
  EXPECT_EQ(simulation.state_hash(), before);
  run(simulation, 5);
  const auto later = simulation.state_hash();
  EXPECT_EQ(simulation.tick_count(), 10);
  ASSERT_TRUE(simulation.restore_snapshot(snapshot).done());
  run(simulation, 5);
  EXPECT_EQ(simulation.state_hash(), later);
}

struct EngineMisdeed {
  const char* name;
  const char* does;
  const char* fault;
};

class FailingEngine : public testing::TestWithParam<EngineMisdeed> {};

TEST_P(FailingEngine, FreezesTheWorldWithAClearWordAndAResetRevivesIt) {
  cycle::Simulation simulation(scene_of(clumsy(GetParam().does)));
  run(simulation, 10);
  EXPECT_TRUE(simulation.frozen());
  EXPECT_EQ(simulation.fault(), std::string("engine 'clumsy': ") + GetParam().fault);
  EXPECT_EQ(simulation.tick_count(), 2);
  EXPECT_DOUBLE_EQ(simulation.state().bodies[0].p_WC.x(), 3e-3) << "the last good state";
  simulation.reset();
  run(simulation, 2);
  EXPECT_FALSE(simulation.frozen()) << "it has begun anew, and fails in its third step only";
}

INSTANTIATE_TEST_SUITE_P(
    Misdeeds, FailingEngine,
    testing::Values(EngineMisdeed{"Throws", "throws", "slipped"},
                    EngineMisdeed{"LeavesNotANumber", "leaves not a number",
                                  "body 'stone' has a velocity that is not finite or beyond 1e6 m/s"},
                    EngineMisdeed{"LeavesNoRotation", "leaves no rotation",
                                  "body 'stone' has a quaternion that is not of unit length"},
                    EngineMisdeed{"LosesABody", "loses a body",
                                  "body 'stone' has a position that is not finite or beyond 1e6 m"},
                    EngineMisdeed{"TellsOfEndlessEffort", "tells of endless effort",
                                  "gives joint 'hinge' an effort that is no finite number"}),
    [](const auto& info) { return info.param.name; });

TEST(PluggedEngineScene, NamesThePlaceOfWhatIsWrong) {
  const std::string with = "plugins: [kinds]\n";
  EXPECT_EQ(error_of_scene(with + "engine: {kind: clumsy, dos: throws}"),
            "s.yaml:3: engine: unknown key 'dos'; did you mean 'does'?");
  EXPECT_EQ(error_of_scene(with + "engine: {kind: clumsy, does: [1]}"),
            "s.yaml:3: engine.does: must be a text, is a list");
  EXPECT_EQ(error_of_scene(with + "engines: {own: {kind: clumsy, does: throws at once}}"),
            "s.yaml:3: engines.own: clumsy: has no arms");
  EXPECT_EQ(error_of_scene("engine: clumsy"),
            "s.yaml:2: engine: there is no engine 'clumsy'; there are: impulse, ode");
  EXPECT_EQ(error_of_scene("plugins: [usurper]\nengine: ode"),
            "s.yaml:3: engine: a plug-in brings an engine 'ode', which Visum has already");
}

TEST(PluggedEngineScene, KeysOfOtherKindsRest) {
  EXPECT_EQ(error_of_scene("plugins: [kinds]\nengine: {kind: clumsy, does: '', step: quick, order: 4}"),
            "no error");
}

}  // namespace
}  // namespace visum
