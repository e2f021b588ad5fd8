#include "clients/visum/run/timeline.h"

#include <gtest/gtest.h>

#include "clients/visum/run/scenario_parts.h"
#include "tests/clients/small_world.h"

namespace visum::run {
namespace {

std::vector<TimelineEntry> entries(const std::string& yaml) {
  const auto list = config::load_text(yaml, "file.yaml");
  std::vector<TimelineEntry> entries;
  for (std::size_t i = 0; i < list.size(); ++i) entries.push_back(read_timeline_entry(list.at(i), {}));
  return entries;
}

std::vector<std::string> said(const std::vector<const TimelineEntry*>& due) {
  std::vector<std::string> texts;
  for (const auto* entry : due) texts.push_back(std::get<Say>(entry->action).text);
  return texts;
}

using Texts = std::vector<std::string>;

TEST(Timeline, AnEntryIsDueOnceAtTheFirstStepAtOrAfterItsTime) {
  const auto list = entries("[{at_s: 0, say: a}, {at_s: 0.02, say: b}, {at_s: 0.015, say: c}]");
  Timeline timeline(list, small_catalogue());
  EXPECT_EQ(said(timeline.due(small_observation(0.0))), (Texts{"a"}));
  EXPECT_EQ(said(timeline.due(small_observation(0.01))), (Texts{}));
  EXPECT_EQ(timeline.missed().size(), 2u);
  EXPECT_EQ(said(timeline.due(small_observation(0.02))), (Texts{"b", "c"})) << "in the order of the file";
  EXPECT_EQ(said(timeline.due(small_observation(0.03))), (Texts{}));
  EXPECT_TRUE(timeline.missed().empty());
}

TEST(Timeline, AConditionIsDueWhenItFirstHolds) {
  const auto list = entries("[{when: {position: {body: box, axis: x}, above: 2}, say: far}]");
  Timeline timeline(list, small_catalogue());
  Observation now = small_observation(0.01);
  EXPECT_TRUE(timeline.due(now).empty());
  now.world.poses[0] = 2.5;
  EXPECT_EQ(said(timeline.due(now)), (Texts{"far"}));
  EXPECT_TRUE(timeline.due(now).empty());
}

TEST(Timeline, ACoverageGoesOnWhenABodyWent) {
  const auto list = entries("[{when: {" + std::string(kPillarFloor) + ", above: 0.5}, say: half}]");
  Catalogue catalogue = pillar_catalogue();
  Timeline timeline(list, catalogue);
  EXPECT_TRUE(timeline.due(pillar_observation(0.01)).empty());
  remove_table(catalogue);
  timeline.tie_again(catalogue);
  Observation now = pillar_observation(0.02);
  remove_table(now);
  now.world.poses[0] = 3;
  EXPECT_EQ(said(timeline.due(now)), (Texts{"half"})) << "4 cells of 15, and 4 more";
}

TEST(Timeline, WhatAnActionNamesMustBeThere) {
  const struct {
    const char* yaml;
    const char* message;
  } cases[] = {
      {"[{at_s: 0, set: {part: amr, port: Halt, value: 1}}]",
       "file.yaml:1: [0]: there is no part 'amr'; did you mean 'arm'?"},
      {"[{at_s: 0, set: {part: arm, port: Hlat, value: 1}}]",
       "file.yaml:1: [0]: there is no port of part 'arm' called 'Hlat'; did you mean 'Halt'?"},
      {"[{at_s: 0, set: {part: arm, port: Actual Angle 1, value: 1}}]",
       "file.yaml:1: [0]: 'Actual Angle 1' is a sensor output and cannot be set"},
      {"[{at_s: 0, set: {part: arm, port: Desired Angle 1, value: 7}}]",
       "file.yaml:1: [0]: port 'Desired Angle 1' takes -6 .. 6, not 7"},
      {"[{at_s: 0, push: {body: bux, force_n: [0, 0, 1]}}]",
       "file.yaml:1: [0]: there is no body 'bux'; did you mean 'box'?"},
      {"[{at_s: 0, remove_body: tabel}]",
       "file.yaml:1: [0]: there is no body 'tabel'; did you mean 'table'?"},
      {"[{at_s: 0, parameter: {part: arm, name: gian, value: 1}}]",
       "file.yaml:1: [0]: there is no parameter of part 'arm' called 'gian'; did you mean 'gain'?"},
      {"[{at_s: 0, fault: {part: arm, kind: encoder_stuk}}]",
       "file.yaml:1: [0]: there is no fault of part 'arm' called 'encoder_stuk'; did you mean "
       "'encoder_stuck'?"},
      {"[{at_s: 0, fault: {part: arm, kind: encoder_stuck, numbers: {jiont: 1}}}]",
       "file.yaml:1: [0]: there is no number of fault 'encoder_stuck' called 'jiont'; did you mean "
       "'joint'?"},
  };
  for (const auto& wrong : cases) {
    const auto list = entries(wrong.yaml);
    try {
      Timeline timeline(list, small_catalogue());
      ADD_FAILURE() << "nothing was thrown for " << wrong.yaml;
    } catch (const config::ConfigError& error) {
      EXPECT_STREQ(error.what(), wrong.message);
    }
  }
}

}  // namespace
}  // namespace visum::run
