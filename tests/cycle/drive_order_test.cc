// How far an arm with drives is from where shorter ticks would take it, in a world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/cycle/text_world.h"

namespace visum::cycle {
namespace {

using Way = std::vector<std::vector<double>>;  // of all joints, every ms

// The Amtec arm goes 0.3 rad with each joint. Its gears have no backlash, and its loops run every ms, so that
// the tick alone makes a difference.
Way way_of_the_arm(const std::string& engine, int ticks_per_ms) {
  const std::string models = VISUM_SOURCE_DIR "/models";
  const test::TempFiles files;
  std::string drives = files.read(models + "/amtec_arm/drives.yaml");
  const auto replace = [&](const std::string& what, const std::string& with) {
    int times = 0;
    for (auto at = drives.find(what); at != std::string::npos; at = drives.find(what, at + with.size())) {
      drives.replace(at, what.size(), with);
      ++times;
    }
    return times;
  };
  EXPECT_EQ(replace("speed_filter_s: 0.002}", "speed_filter_s: 0.002, period_s: 0.001}"), 8);
  EXPECT_EQ(replace("backlash_rad: 1.5e-4", "backlash_rad: 0"), 7);
  Simulation world(scene_of("engine: " + engine + "\ntick_ms: " + std::to_string(1.0 / ticks_per_ms) +
                            "\nmodels: [{name: arm, file: " + models +
                            "/amtec_arm/amtec_arm.urdf, joints: {joint_2: -0.4, joint_4: 1.6, joint_6: 1.418,"
                            " finger_left_joint: 0.017, finger_right_joint: 0.017}}]\n"
                            "parts: [{name: arm, kind: amtec_arm, model: arm, drives: " +
                            files.write("drives.yaml", drives).string() + "}]\n"));
  run(world, 200 * ticks_per_ms);  // brakes open, and gears are loaded
  std::vector<double> targets(world.parts()[0].controller_inputs.begin(),
                              world.parts()[0].controller_inputs.begin() + 7);
  for (double& target : targets) target += 0.3;
  world.write_inputs(0, 0, targets);
  Way way;
  for (int ms = 0; ms < 400; ++ms) {
    run(world, ticks_per_ms);
    way.emplace_back();
    for (const auto& joint : world.state().joints) way.back().push_back(joint.position);
  }
  EXPECT_GT(std::abs(way.back()[0]), 0.05) << "it moves";
  return way;
}

double distance(const Way& a, const Way& b) {
  double most = 0.0;
  for (std::size_t ms = 0; ms < a.size(); ++ms)
    for (std::size_t joint = 0; joint < 7; ++joint)
      most = std::max(most, std::abs(a[ms][joint] - b[ms][joint]));
  return most;
}

// An increment of the encoders is 2.6e-6 rad: that is how well the loop knows where the axis is. Backward
// Euler was 1.3e-5 away.
TEST(DriveOrder, AnArmAtTicksOfOneMsIsWithinTwoIncrementsOfShortTicks) {
  const Way fine = way_of_the_arm("impulse", 16);
  EXPECT_LT(distance(way_of_the_arm("impulse", 1), fine), 5e-6);
  EXPECT_LT(distance(way_of_the_arm("impulse", 2), fine), 2e-6);
}

// ODE moves joints by the speed at the end of a tick: of first order, and an increment needs shorter ticks.
TEST(DriveOrder, WithOdeTheErrorFallsWithTheTick) {
  const Way fine = way_of_the_arm("ode", 16);
  const double coarse = distance(way_of_the_arm("ode", 1), fine);
  EXPECT_LT(coarse, 3e-5);
  // By first order (1/4 - 1/16) / (1 - 1/16) = 0.2 of it is left; the encoders' increments add some.
  EXPECT_LT(distance(way_of_the_arm("ode", 4), fine), 0.3 * coarse);
}

}  // namespace
}  // namespace visum::cycle
