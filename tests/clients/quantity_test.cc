#include "clients/visum/run/quantity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/clients/small_world.h"

namespace visum::run {
namespace {

struct Measured {
  double value;
  std::string unit, text;
};

Measured measure(const std::string& kind, const std::string& yaml,
                 const Observation& now = small_observation()) {
  const auto spec = read_quantity(kind, config::load_text(yaml, "test"));
  Quantity quantity = tie(spec, small_catalogue());
  return {quantity.measure(quantity, now), quantity.unit, quantity.text};
}

TEST(Quantity, DistanceToAPointAndToABody) {
  const auto point = measure("distance", "{body: box, to: [1, 2, 5]}");
  EXPECT_DOUBLE_EQ(point.value, 2.0);
  EXPECT_EQ(point.unit, "m");
  EXPECT_EQ(point.text, "distance of box to (1 2 5)");
  EXPECT_DOUBLE_EQ(measure("distance", "{body: box, to: table}").value, std::sqrt(14.0));
  EXPECT_DOUBLE_EQ(measure("distance", "{body: box, to: table, axes: xy}").value, std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(measure("distance", "{body: box, to: table, axes: z}").value, 3.0);
}

TEST(Quantity, PositionIsOneCoordinate) {
  EXPECT_DOUBLE_EQ(measure("position", "{body: box, axis: y}").value, 2.0);
}

TEST(Quantity, TiltIsTheAngleToTheVertical) {
  Observation now = small_observation();
  EXPECT_NEAR(measure("tilt", "{body: box}", now).value, 0.0, 1e-12);
  EXPECT_NEAR(measure("tilt", "{body: box, axis: x}", now).value, M_PI / 2, 1e-12);
  const double half = 0.3 / 2;  // turned about x by 0.3 rad
  now.world.poses = {0, 0, 0, std::cos(half), std::sin(half), 0, 0, 0, 0, 0, 1, 0, 0, 0};
  EXPECT_NEAR(measure("tilt", "{body: box}", now).value, 0.3, 1e-12);
  EXPECT_NEAR(measure("tilt", "{body: box, axis: y}", now).value, M_PI / 2 - 0.3, 1e-12);
  now.world.poses = {0, 0, 0, std::cos(half), 0, std::sin(half), 0, 0, 0, 0, 1, 0, 0, 0};
  EXPECT_NEAR(measure("tilt", "{body: box, axis: x}", now).value, M_PI / 2 + 0.3, 1e-12);
}

TEST(Quantity, SpeedsAreMagnitudes) {
  Observation now = small_observation();
  now.world.velocities = {3, 4, 0, 0, 0, -2, 0, 0, 0, 0, 0, 0};
  EXPECT_DOUBLE_EQ(measure("speed", "{body: box}", now).value, 5.0);
  EXPECT_DOUBLE_EQ(measure("angular_speed", "{body: box}", now).value, 2.0);
  EXPECT_DOUBLE_EQ(measure("speed", "{body: table}", now).value, 0.0);
}

TEST(Quantity, ContactsInEitherOrder) {
  Observation now = small_observation();
  EXPECT_EQ(measure("touching", "{body: box, with: table}", now).value, 0.0);
  now.world.contacts.push_back({1, 0, {0, 0, 0}, {0, 0, 1}, 0.0, 5.0});
  EXPECT_EQ(measure("touching", "{body: box, with: table}", now).value, 1.0);
  EXPECT_EQ(measure("touching", "{body: table, with: box}", now).value, 1.0);
  EXPECT_DOUBLE_EQ(measure("contact_force", "{body: box}", now).value, 12.5);
}

TEST(Quantity, JointsHaveTheUnitsOfTheirKind) {
  EXPECT_DOUBLE_EQ(measure("joint_position", "{joint: arm/joint_1}").value, 0.25);
  EXPECT_EQ(measure("joint_speed", "{joint: arm/joint_1}").unit, "rad/s");
  EXPECT_EQ(measure("joint_speed", "{joint: arm/finger}").unit, "m/s");
  EXPECT_DOUBLE_EQ(measure("joint_effort", "{joint: arm/finger}").value, -4.0);
  EXPECT_EQ(measure("joint_effort", "{joint: arm/finger}").unit, "N");
}

TEST(Quantity, FollowingErrorOfAPartIsTheLargestOfItsJoints) {
  Observation now = small_observation();
  EXPECT_DOUBLE_EQ(measure("peak_following_error", "{part: arm}", now).value, 0.003);
  EXPECT_EQ(measure("peak_following_error", "{part: arm}", now).unit, "rad or m");
  EXPECT_DOUBLE_EQ(measure("peak_following_error", "{joint: arm/finger}", now).value, 0.001);
  now.world.peak_following_errors = {std::numeric_limits<double>::quiet_NaN(), 0.001};
  EXPECT_TRUE(std::isnan(measure("peak_following_error", "{part: arm}", now).value));
}

TEST(Quantity, PortsOfBothVectorsAndTheirBits) {
  EXPECT_DOUBLE_EQ(measure("port", "{part: arm, name: Actual Angle 1}").value, 0.25);
  EXPECT_DOUBLE_EQ(measure("port", "{part: arm, name: Desired Angle 1}").value, 0.3);
  EXPECT_DOUBLE_EQ(measure("port", "{part: arm, name: Module State 1, mask: 4}").value, 4.0);
  EXPECT_DOUBLE_EQ(measure("port", "{part: arm, name: Module State 1, mask: 1}").value, 0.0);
}

TEST(Quantity, TimeIsSimulated) {
  EXPECT_DOUBLE_EQ(measure("time", "{}", small_observation(1.5)).value, 1.5);
}

TEST(Quantity, AShortSampleIsNoNumber) {
  Observation empty;
  for (const char* body : {"distance", "speed", "contact_force"}) {
    const bool needs_target = std::string(body) == "distance";
    const auto yaml = needs_target ? "{body: box, to: table}" : "{body: box}";
    EXPECT_TRUE(std::isnan(measure(body, yaml, empty).value)) << body;
  }
  EXPECT_TRUE(std::isnan(measure("port", "{part: arm, name: Actual Angle 1}", empty).value));
}

TEST(Quantity, EveryKindHasHelpAndTellsUnknownKeys) {
  for (const QuantityKind& kind : quantity_kinds()) {
    EXPECT_FALSE(std::string(kind.help).empty()) << kind.name;
    EXPECT_THROW(read_quantity(kind.name, config::load_text("{nonsense: 1}", "test")), config::ConfigError)
        << kind.name;
  }
}

}  // namespace
}  // namespace visum::run
