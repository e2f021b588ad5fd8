#include "clients/visum/run/scenario_reader.h"

#include <gtest/gtest.h>

#include <csignal>

namespace visum::run {
namespace {

const char* kWhole = R"(visum_scenario: 1
name: whole
description: everything once
scene: models/scenes/amtec_arm.yaml
clock: realtime
engine: ode
seed: 7
until: {port: {part: arm, name: Part State}, equals: 0, within: 0.5}
max_sim_s: 12.5
max_wall_s: 100
start_wall_s: 5
settle_s: 0.5
check_every_ms: 2
controllers:
  - {name: one, command: ["{bin}/one", "--connect", "{connect}"]}
  - {name: two, command: [two], client: second, joins: false}
timeline:
  - {at_s: 1, set: {part: arm, port: Halt, value: 1, take: true}}
  - {when: {time: {}, above: 2}, push: {body: box, force_n: [1, 2, 3], duration_s: 0.2}}
  - {at_s: 3, parameter: {part: arm, name: gain, value: 2.5}}
  - {at_s: 4, kill: one}
  - {at_s: 4, signal: {controller: two, signal: TERM}}
  - {at_s: 5, remove_body: box}
  - {at_s: 6, say: so}
checks:
  - {name: far, that: {distance: {body: box, to: [0, 0, 0], axes: xy}, above: 1}, when: {from_s: 1, to_s: 2}}
  - {that: {tilt: {body: box}, between: [0, 0.1]}, when: {by_s: 3}}
  - {that: {speed: {body: box}, below: 1}}
)";

TEST(ScenarioReader, ReadsEverything) {
  const Scenario scenario = read_scenario(config::load_text(kWhole, "whole.yaml", VISUM_SOURCE_DIR));
  EXPECT_EQ(scenario.name, "whole");
  EXPECT_EQ(scenario.scene, std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  EXPECT_EQ(scenario.clock, "realtime");
  EXPECT_EQ(scenario.engine, "ode");
  EXPECT_EQ(scenario.seed, 7);
  EXPECT_EQ(scenario.until.kind, Until::Kind::kCondition);
  EXPECT_EQ(scenario.until.condition->bounds.within, 0.5);
  EXPECT_EQ(scenario.max_sim_s, 12.5);
  EXPECT_EQ(scenario.max_wall_s, 100.0);
  EXPECT_EQ(scenario.start_wall_s, 5.0);
  EXPECT_EQ(scenario.settle_s, 0.5);
  EXPECT_EQ(scenario.check_every_ms, 2.0);
}

TEST(ScenarioReader, ReadsControllers) {
  const Scenario scenario = read_scenario(config::load_text(kWhole, "whole.yaml", VISUM_SOURCE_DIR));
  ASSERT_EQ(scenario.controllers.size(), 2u);
  EXPECT_EQ(scenario.controllers[0].command.size(), 3u);
  EXPECT_EQ(scenario.controllers[0].client, "one") << "without `client` it is the controller's name";
  EXPECT_FALSE(scenario.controllers[0].joins.has_value());
  EXPECT_EQ(scenario.controllers[1].client, "second");
  EXPECT_EQ(scenario.controllers[1].joins, false);
}

TEST(ScenarioReader, ReadsTheTimeline) {
  const Scenario scenario = read_scenario(config::load_text(kWhole, "whole.yaml", VISUM_SOURCE_DIR));
  ASSERT_EQ(scenario.timeline.size(), 7u);
  const auto& set = std::get<SetPort>(scenario.timeline[0].action);
  EXPECT_EQ(set.port, "Halt");
  EXPECT_TRUE(set.take);
  const auto& push = std::get<Push>(scenario.timeline[1].action);
  EXPECT_EQ(push.force_n, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(push.duration_s, 0.2);
  EXPECT_TRUE(scenario.timeline[1].when.has_value());
  EXPECT_EQ(std::get<SetParameter>(scenario.timeline[2].action).value, "2.5");
  EXPECT_EQ(std::get<Signal>(scenario.timeline[3].action).number, SIGKILL);
  EXPECT_EQ(std::get<Signal>(scenario.timeline[4].action).number, SIGTERM);
  EXPECT_EQ(std::get<RemoveBody>(scenario.timeline[5].action).body, "box");
  EXPECT_EQ(std::get<Say>(scenario.timeline[6].action).text, "so");
}

TEST(ScenarioReader, ReadsChecks) {
  const Scenario scenario = read_scenario(config::load_text(kWhole, "whole.yaml", VISUM_SOURCE_DIR));
  ASSERT_EQ(scenario.checks.size(), 3u);
  EXPECT_EQ(scenario.checks[0].when.kind, Window::Kind::kAlways);
  EXPECT_EQ(scenario.checks[0].when.to_s, 2.0);
  EXPECT_EQ(scenario.checks[0].that.quantity.axes, "xy");
  EXPECT_EQ(scenario.checks[1].when.kind, Window::Kind::kEventually);
  EXPECT_EQ(scenario.checks[2].when.kind, Window::Kind::kEnd);
}

TEST(ScenarioReader, WhatIsNotSaidHasItsDefault) {
  const Scenario scenario = read_scenario(
      config::load_text("{visum_scenario: 1, name: n, scene: models/scenes/amtec_arm.yaml, until: {at_s: 1}}",
                        "t", VISUM_SOURCE_DIR));
  EXPECT_EQ(scenario.clock, "lockstep");
  EXPECT_EQ(scenario.max_sim_s, 60.0);
  EXPECT_EQ(scenario.max_wall_s, 300.0);
  EXPECT_EQ(scenario.check_every_ms, 10.0);
  EXPECT_EQ(scenario.settle_s, 0.0);
  EXPECT_FALSE(scenario.engine.has_value());
  EXPECT_FALSE(scenario.seed.has_value());
}

TEST(ScenarioReader, ReadsEveryScenarioThatIsShipped) {
  int read = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(VISUM_SOURCE_DIR) + "/models/scenarios")) {
    if (entry.path().extension() != ".yaml") continue;
    EXPECT_NO_THROW(read_scenario(entry.path())) << entry.path();
    ++read;
  }
  EXPECT_GT(read, 0);
}

}  // namespace
}  // namespace visum::run
