#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

using protocol::Parameter;
using testing::HasSubstr;

// The arm with all joints at 0.
PartBench straight_arm() {
  return PartBench("amtec_arm", arm_context());
}

Parameter find(const hwparts::Part& part, const std::string& name) {
  for (const auto& parameter : part.parameters()) {
    if (parameter.name == name) return parameter;
  }
  throw std::runtime_error("no parameter " + name);
}

TEST(Parameters, HaveUniqueNamesHelpAndAValueInsideTheirBounds) {
  const auto bench = straight_arm();
  std::set<std::string> names;
  for (const auto& parameter : bench.part->parameters()) {
    EXPECT_TRUE(names.insert(parameter.name).second) << parameter.name;
    EXPECT_FALSE(parameter.help.empty()) << parameter.name;
    if (parameter.read_only || !std::holds_alternative<double>(parameter.value)) continue;
    EXPECT_LE(parameter.minimum, std::get<double>(parameter.value)) << parameter.name;
    EXPECT_GE(parameter.maximum, std::get<double>(parameter.value)) << parameter.name;
  }
  EXPECT_EQ(bench.part->description().parameters.size(), names.size());
}

TEST(Parameters, EveryOneThatCanBeSetTakesItsBoundsOrItsPresentValueAndNothingBeyond) {
  auto bench = straight_arm();
  for (const auto& parameter : bench.part->parameters()) {
    EXPECT_EQ(bench.part->set_parameter(parameter.name, parameter.value).has_value(), parameter.read_only)
        << parameter.name;
    if (parameter.read_only || !std::holds_alternative<double>(parameter.value)) continue;
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e308, -1e308,
                             parameter.maximum * 1.001 + 1e-9}) {
      EXPECT_TRUE(bench.part->set_parameter(parameter.name, bad)) << parameter.name << " " << bad;
    }
    EXPECT_TRUE(bench.part->set_parameter(parameter.name, std::string("fast"))) << parameter.name;
    EXPECT_EQ(find(*bench.part, parameter.name).value, parameter.value) << parameter.name;
  }
}

TEST(Parameters, UnknownNamesAreRefusedByName) {
  auto bench = straight_arm();
  EXPECT_THAT(bench.part->set_parameter("Position Gain 9", 1.0).value_or(""), HasSubstr("Position Gain 9"));
}

TEST(Parameters, ReadingsCannotBeSet) {
  auto bench = straight_arm();
  EXPECT_THAT(bench.part->set_parameter("Winding Temperature 1", 20.0).value_or(""),
              HasSubstr("can only be read"));
}

TEST(Parameters, MaximumAccelerationActs) {
  auto bench = straight_arm();
  ASSERT_EQ(bench.part->set_parameter("Maximum Acceleration 1", 0.5), std::nullopt);
  bench.in("Desired Angle 1") = 1.0;
  bench.run(0.4);
  EXPECT_NEAR(bench.out("Actual Speed 1"), 0.2, 0.03);
}

TEST(Parameters, FollowingErrorLimitActs) {
  auto bench = straight_arm();
  ASSERT_EQ(bench.part->set_parameter("Following Error Limit 1", 1e-4), std::nullopt);
  bench.in("Desired Angle 1") = 1.0;
  bench.run(0.5);
  EXPECT_TRUE(bench.module(1) & bit::kTowError);
}

TEST(Parameters, SoftLimitsActAndMustHoldTheAxis) {
  auto bench = straight_arm();
  EXPECT_THAT(bench.part->set_parameter("Soft Limit Minimum 1", 0.5).value_or(""), HasSubstr("stands at"));
  EXPECT_THAT(bench.part->set_parameter("Soft Limit Maximum 1", -3.1).value_or(""),
              HasSubstr("below the maximum"));
  ASSERT_EQ(bench.part->set_parameter("Soft Limit Maximum 1", 0.5), std::nullopt);
  bench.in("Desired Angle 1") = 1.0;
  bench.run(4.0);
  EXPECT_TRUE(bench.module(1) & bit::kBeyondSoft);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.5, 1e-3);
}

TEST(Parameters, GainsAct) {
  auto soft = straight_arm(), stiff = straight_arm();
  ASSERT_EQ(soft.part->set_parameter("Position Gain 1", 1.0), std::nullopt);
  ASSERT_EQ(soft.part->set_parameter("Velocity Gain 1", 10.0), std::nullopt);
  ASSERT_EQ(soft.part->set_parameter("Velocity Integral Time 1", std::int64_t{0}), std::nullopt);
  soft.plants[0].external = stiff.plants[0].external = 20.0;
  soft.run(5.0);
  stiff.run(5.0);
  EXPECT_GT(soft.out("Actual Angle 1"), 100.0 * std::abs(stiff.out("Actual Angle 1")));
}

TEST(Parameters, OnControllerLostTakesItsTwoWords) {
  auto bench = straight_arm();
  EXPECT_TRUE(bench.part->set_parameter("On Controller Lost", std::string("freeze")));
  ASSERT_EQ(bench.part->set_parameter("On Controller Lost", std::string("hold")), std::nullopt);
  EXPECT_EQ(std::get<std::string>(find(*bench.part, "On Controller Lost").value), "hold");
  bench.part->controller_lost();
  bench.run(0.1);
  EXPECT_EQ(bench.part_state(), 0);
}

TEST(Parameters, WindingTemperatureRisesUnderLoad) {
  auto bench = straight_arm();
  bench.plants[1].external = 100.0;
  bench.run(30.0);
  EXPECT_GT(std::get<double>(find(*bench.part, "Winding Temperature 2").value), 26.0);
  EXPECT_GT(std::get<double>(find(*bench.part, "Gear Peak Load 2").value), 99.0);
}

}  // namespace
}  // namespace visum::test
