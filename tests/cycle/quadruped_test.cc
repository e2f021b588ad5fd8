// A quadruped stands on the stiffness and damping of its joints, with no controller and no plug-in.
#include <gtest/gtest.h>

#include "server/cycle/simulation.h"

namespace visum::cycle {
namespace {

scene::Scene quadruped(const std::string& engine) {
  scene::Options options;
  options.parameters = "{engine: " + engine + "}";
  return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/quadruped.yaml", options);
}

class Quadruped : public testing::TestWithParam<const char*> {};

TEST_P(Quadruped, StandsByItself) {
  Simulation simulation(quadruped(GetParam()));
  const auto trunk = simulation.model().find_body("dog/trunk").index();
  for (int i = 0; i < 1500; ++i) simulation.tick();
  const double settled = simulation.state().bodies[trunk].p_WC.z();
  for (int i = 0; i < 1500; ++i) simulation.tick();
  const auto& body = simulation.state().bodies[trunk];
  EXPECT_GT(body.p_WC.z(), 0.29) << "0.326 m less what the knees give way";
  EXPECT_LT(body.p_WC.z(), 0.33);
  EXPECT_NEAR(body.p_WC.z(), settled, 1e-3) << "it neither sinks nor hops";
  EXPECT_GT((body.q_WB * Eigen::Vector3d::UnitZ()).z(), 0.99) << "upright";
  EXPECT_LT(body.p_WC.head<2>().norm(), 0.05) << "where it was";
  double weight = 0.0;
  for (const auto& contact : simulation.contacts()) weight += contact.normal_force_n;
  EXPECT_NEAR(weight, 12.0 * 9.81, 2.0);
}

TEST_P(Quadruped, StandsWithTheSameBitsTwice) {
  Simulation a(quadruped(GetParam())), b(quadruped(GetParam()));
  for (int i = 0; i < 500; ++i) {
    a.tick();
    b.tick();
    ASSERT_EQ(a.state_hash(), b.state_hash()) << i;
  }
}

// The same stance without stiffness falls: so it is the law that carries the robot.
TEST_P(Quadruped, FallsOnceItsJointsGoLimp) {
  Simulation simulation(quadruped(GetParam()));
  const auto trunk = simulation.model().find_body("dog/trunk").index();
  for (int i = 0; i < 200; ++i) simulation.tick();
  const std::vector<double> none(24, 0.0);  // Stiffness 1..12 and Damping 1..12
  simulation.write_inputs(0, 36, none);
  for (int i = 0; i < 1000; ++i) simulation.tick();
  EXPECT_LT(simulation.state().bodies[trunk].p_WC.z(), 0.2);
}

INSTANTIATE_TEST_SUITE_P(Engines, Quadruped, testing::Values("impulse", "ode"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace visum::cycle
