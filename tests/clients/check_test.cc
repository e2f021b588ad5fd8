#include "clients/visum/run/check.h"

#include <gtest/gtest.h>

#include "clients/visum/run/scenario_parts.h"
#include "tests/clients/small_world.h"

namespace visum::run {
namespace {

// A check of the box's height, which takes these values at 0.01 s, 0.02 s, ...
CheckResult follow(const std::string& yaml, const std::vector<double>& heights) {
  const CheckSpec spec = read_check(config::load_text(yaml, "test"));
  Check check(spec, small_catalogue());
  double time_s = 0.0;
  for (const double height : heights) {
    Observation now = small_observation(time_s += 0.01);
    now.world.poses[2] = height;
    check.observe(now);
  }
  return check.result();
}

TEST(Check, AtTheEndTheLastStepCounts) {
  const std::string yaml = "{that: {position: {body: box, axis: z}, below: 1}}";
  EXPECT_TRUE(follow(yaml, {5, 5, 0.5}).passed);
  const auto failed = follow(yaml, {0, 0, 1.5});
  EXPECT_FALSE(failed.passed);
  EXPECT_EQ(failed.failure, "z of box must be below 1 m at the end, is 1.5 m at 0.030 s");
  EXPECT_EQ(failed.name, "z of box below 1 m") << "a check without a name is named by what it says";
}

TEST(Check, AlwaysKeepsTheWorstValueAndItsTime) {
  const std::string yaml = "{name: low, that: {position: {body: box, axis: z}, below: 1}, when: always}";
  const auto passed = follow(yaml, {0.1, 0.9, 0.2});
  EXPECT_TRUE(passed.passed);
  EXPECT_DOUBLE_EQ(*passed.value, 0.9);
  EXPECT_DOUBLE_EQ(passed.at_s, 0.02);
  const auto failed = follow(yaml, {0.1, 2.0, 0.2});
  EXPECT_EQ(failed.failure, "z of box must be below 1 m always, is 2 m at 0.020 s");
}

TEST(Check, AlwaysIsNotForgiven) {
  const std::string yaml = "{that: {position: {body: box, axis: z}, below: 1}, when: always}";
  EXPECT_FALSE(follow(yaml, {1.0, 0.5, 0.5}).passed) << "on the bound is not below it";
  EXPECT_FALSE(follow(yaml, {2.0, 0.5}).passed);
}

TEST(Check, EventuallyKeepsTheBest) {
  const std::string yaml = "{that: {position: {body: box, axis: z}, above: 1}, when: eventually}";
  EXPECT_TRUE(follow(yaml, {0, 2, 0}).passed);
  const auto failed = follow(yaml, {0, 0.9, 0});
  EXPECT_EQ(failed.failure, "z of box must be above 1 m at some time, is 0.9 m at 0.020 s");
}

TEST(Check, AWindowIncludesItsEnds) {
  const std::string yaml =
      "{that: {position: {body: box, axis: z}, below: 1}, when: {from_s: 0.02, to_s: 0.03}}";
  EXPECT_TRUE(follow(yaml, {9, 0, 0, 9}).passed);
  EXPECT_FALSE(follow(yaml, {0, 9, 0, 0}).passed);
  EXPECT_FALSE(follow(yaml, {0, 0, 9, 0}).passed);
}

TEST(Check, BySomeTimeIsTooLateAfterIt) {
  const std::string yaml = "{that: {position: {body: box, axis: z}, above: 1}, when: {by_s: 0.02}}";
  EXPECT_TRUE(follow(yaml, {0, 2}).passed);
  EXPECT_FALSE(follow(yaml, {0, 0, 2}).passed);
}

TEST(Check, AWindowThatTheRunDidNotReachIsNotPassed) {
  const auto result = follow("{that: {position: {body: box, axis: z}, below: 1}, when: {from_s: 5}}", {0, 0});
  EXPECT_FALSE(result.passed);
  EXPECT_FALSE(result.value.has_value());
  EXPECT_EQ(result.failure, "z of box must be below 1 m from 5 s on, but the run had no step in that time");
}

// At 0.01 s the box stands at (1, 2), then the table goes, and at 0.02 s it stands at (3, 2).
std::optional<double> covered_as_a_body_goes(const std::string& when) {
  const CheckSpec spec = read_check(
      config::load_text("{that: {" + std::string(kPillarFloor) + ", above: 0}, when: " + when + "}", "test"));
  Catalogue catalogue = pillar_catalogue();
  Check check(spec, catalogue);
  check.observe(pillar_observation(0.01));
  remove_table(catalogue);
  check.tie_again(catalogue);
  Observation now = pillar_observation(0.02);
  remove_table(now);
  now.world.poses[0] = 3;
  check.observe(now);
  return check.result().value;
}

TEST(Check, CoverageGoesOnWhereABodyWentAmongThePillars) {
  EXPECT_EQ(covered_as_a_body_goes("end"), 8.0 / 15);
  EXPECT_EQ(covered_as_a_body_goes("{from_s: 0.02}"), 4.0 / 15) << "begun when it was gone already";
}

TEST(Check, NamesOfTheWorldThatAreUnknownAreTheFilesFault) {
  const CheckSpec spec = read_check(config::load_text("that: {speed: {body: bax}, below: 1}", "file.yaml"));
  try {
    Check check(spec, small_catalogue());
    FAIL() << "nothing was thrown";
  } catch (const config::ConfigError& error) {
    EXPECT_STREQ(error.what(), "file.yaml:1: that.speed: there is no body 'bax'; did you mean 'box'?");
  }
}

}  // namespace
}  // namespace visum::run
