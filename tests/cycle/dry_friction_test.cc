// Gears with dry friction in a world: what Coulomb's law holds stays where it is, with both engines.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "tests/cycle/text_world.h"

namespace visum::cycle {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
  return text;
}

// The two-link arm, held out against gravity, with drives that have dry friction (N·m) and no supply.
struct UnpoweredArm {
  UnpoweredArm(const std::string& engine, const std::string& friction, const std::string& more)
      : world(make_scene(engine, friction, more)) {
    EXPECT_TRUE(world.set_parameter(0, "Supply Voltage", 0.0).done());
  }
  scene::Scene make_scene(const std::string& engine, const std::string& friction,
                          const std::string& more) const {
    const std::string models = VISUM_SOURCE_DIR "/models", dry = "0\n      dry_friction_nm: " + friction;
    std::string drives = files.read(models + "/two_link/drives.yaml");
    for (const char* smooth : {"1.5", "0.8"})
      drives = replaced(drives, std::string("coulomb_friction_nm: ") + smooth, "coulomb_friction_nm: " + dry);
    drives = replaced(drives, "      peak_torque", more + "      peak_torque");
    return scene_of("engine: " + engine + "\nmodels: [{name: robot, file: " + models +
                    "/two_link/two_link.urdf, joints: {shoulder: 0.4, elbow: 0.8}}]\n"
                    "parts: [{name: robot, kind: servo_group, model: robot, drives: " +
                    files.write("drives.yaml", drives).string() + "}]\n");
  }

  test::TempFiles files;
  Simulation world;
};

double turned(const Simulation& world) {
  const auto& joints = world.state().joints;
  return std::max(std::abs(joints[0].position - 0.4), std::abs(joints[1].position - 0.8));
}

class DryFrictionInAWorld : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(DryFrictionInAWorld, HoldsAnArmWithoutPower) {
  const auto [engine, more] = GetParam();
  UnpoweredArm arm(engine, "7", more);
  Simulation& held = arm.world;
  run(held, 500);  // an elastic gear gives way by its play and its torsion
  const double there = held.state().joints[0].position;
  EXPECT_LT(turned(held), 2e-3);
  run(held, 4000);
  // The rotor of an elastic gear sticks to the bit. A rigid one is held by the engine's row, which yields a
  // little.
  EXPECT_NEAR(held.state().joints[0].position, there, *more == 0 ? 2e-8 : 1e-10);
  UnpoweredArm falls(engine, "0.5", more);
  run(falls.world, 1000);
  EXPECT_GT(turned(falls.world), 0.3);
}

INSTANTIATE_TEST_SUITE_P(
    EnginesAndGears, DryFrictionInAWorld,
    testing::Combine(testing::Values("impulse", "ode"),
                     testing::Values("",
                                     "      stiffness_nm_per_rad: 20000\n"
                                     "      damping_nm_s_per_rad: 20\n      backlash_rad: 1.0e-4\n")),
    [](const auto& info) {
      return std::string(std::get<0>(info.param)) + (*std::get<1>(info.param) == 0 ? "Rigid" : "Elastic");
    });

}  // namespace
}  // namespace visum::cycle
