// Joints that turn by more than half a turn in a tick, and the steps of a higher order.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/dynamics/lab.h"

namespace visum::dynamics::testing {
namespace {

using world::JointKind;

constexpr double kFast = 400.0;  // rad/s: 4 rad in a tick of 10 ms

world::EngineSetting of_order(int order) {
  world::EngineSetting setting;
  setting.name = "impulse";
  setting.order = order;
  return setting;
}

// About z, through its centre of mass.
ModelBuilder wheel(world::EngineSetting setting, JointKind kind, double pitch_m) {
  ModelBuilder b(setting);
  b.model.gravity.setZero();
  b.model.tick_ns = 10'000'000;
  const BodyId wheel = b.add_rotor("wheel", 1.0, 1e-2, at(0, 0, 0));
  world::Joint& joint =
      b.add_joint("axle", kind, {}, wheel, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ());
  joint.pitch_m = pitch_m;
  b.body(wheel).w_WB = {0.0, 0.0, kFast};
  b.body(wheel).v_WB = {0.0, 0.0, kFast * pitch_m / (2.0 * std::numbers::pi)};
  return b;
}

class FastTurns : public ::testing::TestWithParam<const char*> {};

TEST_P(FastTurns, AreCountedForwardsAndLiftAScrew) {
  world::EngineSetting setting = of_order(2);
  setting.solver = GetParam();
  Lab hinge(wheel(setting, JointKind::kHinge, 0.0).model);
  Lab screw(wheel(setting, JointKind::kScrew, 5e-3).model);
  hinge.run(0.1);
  screw.run(0.1);
  EXPECT_NEAR(hinge.joint("axle").position, 40.0, 1e-6);
  EXPECT_NEAR(screw.joint("axle").position, 40.0, 1e-3);
  EXPECT_NEAR(screw.body("wheel").p_WC.z(), 40.0 * 5e-3 / (2.0 * std::numbers::pi), 1e-5);
}
INSTANTIATE_TEST_SUITE_P(Solvers, FastTurns, ::testing::Values("direct", "iterate"));

TEST(Orders, LiftAScrewByTheTurnsOfAllTheirSteps) {
  for (const int order : {4, 6}) {
    auto b = wheel(of_order(order), JointKind::kScrew, 5e-3);
    b.body({0}).w_WB *= 4.0;
    b.body({0}).v_WB *= 4.0;
    Lab lab(b.model);
    lab.run(0.1);
    EXPECT_NEAR(lab.joint("axle").position, 160.0, 1e-9) << order;
    EXPECT_NEAR(lab.body("wheel").p_WC.z(), 160.0 * 5e-3 / (2.0 * std::numbers::pi), 1e-9) << order;
  }
}

TEST(Orders, StopsThatAreFarOffCostNoAccuracy) {
  const auto swing = [](bool limited) {
    ModelBuilder b(of_order(6));
    b.model.tick_ns = 10'000'000;
    const BodyId body = b.add_rotor("body", 1.0, 1e-2, at(1, 0, 0));
    world::Joint& joint =
        b.add_joint("hinge", JointKind::kHinge, {}, body, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY());
    joint.limited = limited;
    joint.lower = -100.0;
    joint.upper = 100.0;
    Lab lab(b.model);
    lab.run(2.0);
    return lab.joint("hinge").position;
  };
  EXPECT_EQ(swing(true), swing(false));
}

}  // namespace
}  // namespace visum::dynamics::testing
