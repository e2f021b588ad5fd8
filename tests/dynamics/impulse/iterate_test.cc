// `solver: iterate` of the engine `impulse`: joint after joint, stopped anywhere.
#include <gmock/gmock.h>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::dynamics::testing {
namespace {

world::EngineSetting iterate(int budget) {
  world::EngineSetting setting;
  setting.name = "impulse";
  setting.solver = "iterate";
  setting.budget = budget;
  return setting;
}

double largest_gap(Lab& lab, int ticks) {
  double gap = 0.0;
  for (int i = 0; i < ticks; ++i) {
    lab.run_ticks(1);
    gap = std::max(gap, physics::max_gap(lab.model, lab.state));
  }
  return gap;
}

TEST(Iterate, RefusesAnOrderThatGoesBackInTime) {
  world::EngineSetting setting = iterate(100);
  setting.order = 4;
  EXPECT_THAT([&] { Lab lab(physics::chain(setting, 1e-3, 2)); },
              ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("iterate")));
}

TEST(Iterate, OneCorrectionOfEachJointHoldsAChainTogether) {
  Lab lab(physics::chain(iterate(1), 1e-3, 8));
  const double start = physics::energy_of(lab.model, lab.state);
  EXPECT_LT(largest_gap(lab, 2000), 0.05);
  EXPECT_LT(physics::energy_of(lab.model, lab.state), start);
}

TEST(Iterate, OneCorrectionOfEachJointHoldsLoopsTogether) {
  Lab lab(physics::four_bars(iterate(1), 1e-3, 2));
  EXPECT_LT(largest_gap(lab, 1000), 0.05);
}

TEST(Iterate, WithATightBoundItGoesWhereTheDirectSolverGoes) {
  world::EngineSetting tight = iterate(100'000), direct = iterate(1);
  tight.d_max = 1e-12;
  tight.v_max = 1e-9;
  direct.solver = "direct";
  direct.d_max = 1e-12;
  Lab joint_by_joint(physics::arm7(tight, 1e-3)), at_once(physics::arm7(direct, 1e-3));
  for (Lab* lab : {&joint_by_joint, &at_once}) lab->run(0.05);
  for (std::size_t i = 0; i < at_once.state.bodies.size(); ++i)
    EXPECT_LT((joint_by_joint.state.bodies[i].p_WC - at_once.state.bodies[i].p_WC).norm(), 1e-8) << i;
}

// A door at its stop that a bolt holds as well, pushed to and fro.
TEST(Iterate, ABoltedDoorAtItsStopStaysInItsHinge) {
  ModelBuilder b(iterate(100));
  const BodyId door = b.add_rotor("door", 1.0, 0.05, at(0.4, 0.1, 0.2, 0.3, {1, 2, 3}));
  b.add_joint("hinge", world::JointKind::kHinge, {}, door, {0.05, 0.02, 0.1},
              Eigen::Vector3d(1, 2, 3).normalized())
      .limited = true;
  b.add_joint("bolt", world::JointKind::kPointOnPlane, {}, door, {0.7, 0.2, 0.3},
              Eigen::Vector3d(0.3, 1.0, 0.2).normalized());
  Lab lab(b.model);
  for (int i = 0; i < 20; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    lab.wrenches = {{door, sign * Eigen::Vector3d(30, -20, 10), {1, 2, -3}}};
    EXPECT_LT(largest_gap(lab, 100), 1e-5);
  }
}

}  // namespace
}  // namespace visum::dynamics::testing
