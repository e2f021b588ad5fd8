// ODE's own peculiarities: where its direct solver gives up, and its random generator for the whole process.
#include <gtest/gtest.h>

#include "tests/dynamics/lab.h"

namespace visum::dynamics::testing {
namespace {

world::EngineSetting ode(const char* step) {
  world::EngineSetting setting;
  setting.name = "ode";
  setting.step = step;
  return setting;
}

// Cubes as hulls of their corners. As boxes, their contacts would be too regular to make it give up.
world::WorldModel stack_of_ten() {
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.05, 0.05})
    for (const double y : {-0.05, 0.05})
      for (const double z : {-0.05, 0.05}) corners.emplace_back(x, y, z);
  ModelBuilder b(ode("world"));
  b.add_ground();
  for (int i = 0; i < 10; ++i) b.add_hull("box_" + std::to_string(i), corners, 1.0, at(0, 0, 0.05 + 0.1 * i));
  return b.model;
}

TEST(Ode, AStackOnWhichItsDirectSolverGivesUpStandsAllTheSame) {
  Lab lab(stack_of_ten());
  lab.run(5.0);
  EXPECT_GT(lab.warned_ticks, 0) << "the case is no longer the one that is meant";
  for (int i = 0; i < 10; ++i) {
    EXPECT_LT(lab.body("box_" + std::to_string(i)).p_WC.head<2>().norm(), 1e-5);
    EXPECT_NEAR(lab.body("box_" + std::to_string(i)).p_WC.z(), 0.05 + 0.1 * i, 5e-4);
  }
}

TEST(Ode, WithMoreRowsThanItsLimitItTakesQuickStepForTheTick) {
  ModelBuilder b(ode("world"));
  b.model.engines[0].work_limit = 30;
  b.add_ground();
  for (int i = 0; i < 4; ++i)
    b.add_box("box_" + std::to_string(i), {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0.05 + 0.1 * i));
  b.add_box("alone", {0.1, 0.1, 0.1}, 1.0, at(1, 0, 0.05));  // with 12 rows: not one of the many
  Lab lab(b.model);
  lab.run_ticks(10);
  const StepResult result = lab.step();
  EXPECT_TRUE(result.limited);
  ASSERT_EQ(result.fell_short.size(), 4u);
  for (const BodyId id : result.fell_short) EXPECT_NE(b.model.bodies[id.index()].name, "alone");
  lab.run(1.0);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(lab.body("box_" + std::to_string(i)).p_WC.z(), 0.05 + 0.1 * i, 1e-3);
}

TEST(Ode, ATickOnWhichItsDirectSolverGivesUpIsAFunctionOfTheStateToo) {
  Lab lab(stack_of_ten()), disturbed(stack_of_ten());
  ModelBuilder other(ode("quick"));
  other.add_ground();
  other.add_box("box", {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0.05));
  Lab quick(other.model);
  for (int i = 0; i < 500; ++i) {
    lab.run_ticks(1);
    quick.run_ticks(1);  // moves ODE's generator
    disturbed.run_ticks(1);
  }
  EXPECT_EQ(lab.hash(), disturbed.hash());
}

TEST(Ode, ItsDirectSolverHoldsARowOfFiveBlocksBetweenTwoJaws) {
  ModelBuilder b(ode("world"));
  const BodyId left = b.add_box("left", {0.02, 0.1, 0.1}, 0.3, at(-0.2605, 0, 1));
  const BodyId right = b.add_box("right", {0.02, 0.1, 0.1}, 0.3, at(0.2605, 0, 1));
  for (int i = 0; i < 5; ++i)
    b.add_box("block_" + std::to_string(i), {0.1, 0.1, 0.1}, 1.0, at(-0.2 + 0.1 * i, 0, 1));
  b.add_joint("jaw_left", world::JointKind::kSlider, {}, left, {-0.2605, 0, 1}, {1, 0, 0});
  b.add_joint("jaw_right", world::JointKind::kSlider, {}, right, {0.2605, 0, 1}, {-1, 0, 0});
  Lab lab(b.model);
  for (const char* jaw : {"jaw_left", "jaw_right"}) lab.drive(jaw) = {0.5, 1e-3, 500.0, 0.0};
  lab.run(0.5);
  const double height = lab.body("block_2").p_WC.z();
  EXPECT_GT(height, 0.999);
  lab.run(10.0);
  EXPECT_NEAR(lab.body("block_2").p_WC.z(), height, 1e-6);
}

}  // namespace
}  // namespace visum::dynamics::testing
