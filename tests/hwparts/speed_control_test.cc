// Drives that are commanded by their speed (`control: velocity`) beside drives that are commanded by their
// angle, tested with the cart's drives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hwparts/servo_group/part_state.h"
#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"
#include "tests/support/temp_files.h"

namespace visum::test {
namespace {

using servo_group::PartState;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kSettled_s = 2.0;  // for a ramp, and for the loop to come to rest behind it
constexpr double kAcceleration = 12.0, kMaximumSpeed = 15.0;  // of the wheels, as in models/cart/drives.yaml

hwparts::PartContext cart_context(const std::string& more = "") {
  const std::string entry =
      "{name: cart, kind: servo_group, model: cart, drives: models/cart/drives.yaml" + more + "}";
  hwparts::PartContext context{"cart", config::load_text(entry, "scene", VISUM_SOURCE_DIR), {}, 0.001};
  for (const char* axle : {"rear_left_axle", "rear_right_axle", "front_left_axle", "front_right_axle"})
    context.joints.push_back({axle, false, 1.0, -1.0, 0.0});
  for (const char* knuckle : {"front_left_steering", "front_right_steering"})
    context.joints.push_back({knuckle, false, -0.65, 0.65, 0.0});
  return context;
}

PartBench cart(const std::string& more = "") {
  PartBench bench("servo_group", cart_context(more));
  for (auto& plant : bench.plants) plant.inertia = 0.017;  // a quarter of the cart, as a wheel feels it
  return bench;
}

#define EXPECT_STATE(bench, expected) EXPECT_EQ((bench).part_state(), static_cast<int>(PartState::expected))

TEST(SpeedControl, HasAPortForTheSpeedWhereOthersHaveOneForTheAngle) {
  const auto bench = cart();
  const auto& inputs = bench.part->description().controller_inputs;
  std::vector<std::string> names;
  for (const auto& port : inputs) names.push_back(port.name);
  EXPECT_THAT(names, ElementsAre("Desired Speed 1", "Desired Speed 2", "Desired Speed 3", "Desired Speed 4",
                                 "Desired Angle 5", "Desired Angle 6", "Maximum Speed 1", "Maximum Speed 2",
                                 "Maximum Speed 3", "Maximum Speed 4", "Maximum Speed 5", "Maximum Speed 6",
                                 "Reset", "Home", "Halt", "Execution Enable"));
  EXPECT_EQ(inputs[0].unit, "rad/s");
  EXPECT_EQ(inputs[0].initial, 0.0);
  EXPECT_LT(inputs[0].minimum, -kMaximumSpeed);
}

TEST(SpeedControl, ComesToItsSpeedOnARampAndKeepsIt) {
  auto bench = cart();
  bench.in("Desired Speed 1") = 6.0;
  bench.run(0.25);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 0.25 * kAcceleration, 0.2);
  EXPECT_STATE(bench, kMoving);
  bench.run(2.25);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 6.0, 0.02);
  EXPECT_NEAR(bench.out("Actual Speed 1"), 6.0, 0.1);
  // On the ramp for 0.5 s, at speed for 2 s.
  EXPECT_NEAR(bench.plants[0].joint.position, 0.5 * 0.5 * 6.0 + 2.0 * 6.0, 0.05);
  for (const std::size_t other : {1, 2, 3, 4, 5}) EXPECT_NEAR(bench.plants[other].joint.position, 0.0, 1e-3);
}

TEST(SpeedControl, TurnsRoundThroughAStop) {
  auto bench = cart();
  bench.in("Desired Speed 2") = 6.0;
  bench.run(1.0);
  bench.in("Desired Speed 2") = -6.0;
  bench.run(0.5);
  EXPECT_NEAR(bench.plants[1].joint.velocity, 0.0, 0.5);
  bench.run(1.0);
  EXPECT_NEAR(bench.plants[1].joint.velocity, -6.0, 0.02);
}

TEST(SpeedControl, GoesNoFasterThanItsMaximumSpeed) {
  auto bench = cart();
  bench.in("Desired Speed 1") = 100.0;
  bench.in("Desired Speed 2") = 10.0;
  bench.in("Maximum Speed 2") = 4.0;
  bench.run(2.5);
  EXPECT_NEAR(bench.plants[0].joint.velocity, kMaximumSpeed, 0.05);
  EXPECT_NEAR(bench.plants[1].joint.velocity, 4.0, 0.02);
}

TEST(SpeedControl, TurnsForEver) {
  auto bench = cart();
  bench.plants[0].joint.position = 0.0;
  bench.in("Desired Speed 1") = kMaximumSpeed;
  bench.run(100.0);
  EXPECT_GT(bench.plants[0].joint.position, 1450.0);  // beyond what the ports of an angle can ask for
  EXPECT_NEAR(bench.plants[0].joint.velocity, kMaximumSpeed, 0.05);
  EXPECT_STATE(bench, kMoving);
}

TEST(SpeedControl, AHeldWheelTripsAndStopsAllDrives) {
  auto bench = cart();
  bench.in("Desired Speed 1") = bench.in("Desired Speed 2") = 3.0;
  bench.run(kSettled_s);
  bench.plants[0].upper = bench.plants[0].joint.position;
  bench.run(kSettled_s);
  EXPECT_TRUE(bench.module(1) & bit::kTowError);
  EXPECT_STATE(bench, kFault);
  EXPECT_NEAR(bench.plants[1].joint.velocity, 0.0, 1e-3);
}

TEST(SpeedControl, AfterAResetItStandsUntilAnotherSpeedIsCommanded) {
  auto bench = cart();
  bench.in("Desired Speed 1") = 3.0;
  bench.run(kSettled_s);
  bench.bump("Halt");
  bench.run(kSettled_s);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 0.0, 1e-3);
  EXPECT_STATE(bench, kHalted);
  bench.bump("Reset");
  bench.run(kSettled_s);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 0.0, 1e-3);
  EXPECT_STATE(bench, kReady);
  bench.in("Desired Speed 1") = 2.0;
  bench.run(kSettled_s);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 2.0, 0.02);
}

TEST(SpeedControl, ExecutionEnableStopsAndGoesOn) {
  auto bench = cart();
  bench.in("Desired Speed 1") = 3.0;
  bench.run(kSettled_s);
  bench.in("Execution Enable") = 0.0;
  bench.run(kSettled_s);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 0.0, 1e-3);
  bench.in("Execution Enable") = 1.0;
  bench.run(kSettled_s);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 3.0, 0.02);
}

TEST(SpeedControl, HomesWhereItStops) {
  auto bench = cart(", homed: false");
  bench.in("Desired Speed 1") = 3.0;
  bench.run(kSettled_s);
  EXPECT_STATE(bench, kNotHomed);
  EXPECT_EQ(bench.plants[0].joint.position, 0.0);
  bench.bump("Home");
  bench.run(kSettled_s);
  EXPECT_STATE(bench, kReady);
  EXPECT_NEAR(bench.plants[0].joint.position, 0.0, 1e-3);
  bench.in("Desired Speed 1") = 2.0;
  bench.run(kSettled_s);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 2.0, 0.02);
}

TEST(SpeedControl, ALostControllerStopsIt) {
  auto bench = cart();
  bench.in("Desired Speed 1") = 3.0;
  bench.run(kSettled_s);
  bench.part->controller_lost();
  bench.run(kSettled_s);
  EXPECT_NEAR(bench.plants[0].joint.velocity, 0.0, 1e-3);
  EXPECT_STATE(bench, kControllerLost);
}

TEST(SpeedControl, GoesOnWithTheSameBitsAfterARestore) {
  auto bench = cart();
  bench.in("Desired Speed 1") = 3.0;
  bench.run(0.1);
  const auto saved = bench.save();
  const auto plants = bench.plants;
  bench.run(0.3);
  const auto after = bench.save();
  bench.load(saved);
  bench.plants = plants;
  bench.run(0.3);
  EXPECT_EQ(bench.save(), after);
}

TEST(SpeedControl, AWrongSettingIsRefusedByName) {
  const TempFiles files;
  const auto error = [&](const std::string& from, const std::string& to) {
    std::ifstream file(std::string(VISUM_SOURCE_DIR) + "/models/cart/drives.yaml");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    text.replace(text.find(from), from.size(), to);
    files.write("drives.yaml", text);
    auto context = cart_context();
    context.config = config::load_text("{drives: drives.yaml}", "scene", files.folder());
    return files.error_of([&] { servo_group::load_drives(context); });
  };
  EXPECT_THAT(error("control: velocity", "control: velocty"),
              HasSubstr("must be one of position, velocity, is 'velocty'; did you mean 'velocity'?"));
  EXPECT_THAT(
      error("control: velocity", "control: velocity\n    home: {position_rad: 0, speed_rad_per_s: 1}"),
      HasSubstr("home: means nothing for a drive with 'control: velocity'"));
  EXPECT_THAT(error("control: velocity", "control: position"),
              HasSubstr("missing: home.position_rad, home.speed_rad_per_s"));
}

}  // namespace
}  // namespace visum::test
