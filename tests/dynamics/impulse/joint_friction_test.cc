// Dry friction and stops in the joints of mechanisms that lie on the ground.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/legged_models.h"

namespace visum::dynamics::impulse {
namespace {

using testing::Lab;

constexpr int kFallen = 1300;  // ticks of 1 ms

world::WorldModel figure(int number) {
  return physics::falling_ragdolls(physics::engine_row("impulse").setting, 1e-3, 1, number);
}

double fastest(const Lab& lab) {
  double fastest = 0.0;
  for (const auto& body : lab.state.bodies) fastest = std::max(fastest, body.v_WC.norm());
  return fastest;
}

// These came to rest with joints at their stops and with friction at its limit, and took up to a million
// units of work in each tick from then on.
TEST(JointFriction, FiguresThatLieStillTakeLittleWork) {
  for (const int number : {31, 32, 41, 42, 45, 50, 52}) {
    Lab lab(figure(number));
    lab.run_ticks(kFallen);
    std::uint64_t work = 0;
    for (int tick = 0; tick < 200; ++tick) work += lab.step().work;
    EXPECT_LT(work / 200, 90'000u) << number;
    EXPECT_LT(fastest(lab), 1e-6) << number;
  }
}

TEST(JointFriction, FiguresGoOnWithTheSameBitsFromARestoredState) {
  Lab straight(figure(46)), fresh(figure(46));
  straight.run_ticks(kFallen);
  const auto at_stop = [](const world::Joint& joint, const world::JointState& state) {
    return joint.limited && (state.position <= joint.lower || state.position >= joint.upper);
  };
  bool any = false;
  for (std::size_t i = 0; i < straight.model.joints.size(); ++i)
    any = any || at_stop(straight.model.joints[i], straight.state.joints[i]);
  EXPECT_TRUE(any);
  fresh.state = straight.state;
  straight.run_ticks(100);
  fresh.run_ticks(100);
  EXPECT_EQ(straight.hash(), fresh.hash());
}

// An arm rests on its stop until a servo, which hardly gives way, lifts it: then the servo carries it. The
// stop's row, which nothing can move, must not go on giving what it gave before.
TEST(JointStops, GiveNothingToAnArmThatIsLiftedOff) {
  testing::ModelBuilder b(physics::engine_row("impulse").setting);
  const auto arm = b.add_box("arm", {0.5, 0.05, 0.05}, 4.0, testing::at(0.25, 0.0, 1.0));
  world::Joint& joint =
      b.add_joint("hinge", world::JointKind::kHinge, {}, arm, {0.0, 0.0, 1.0}, Eigen::Vector3d::UnitY());
  joint.limited = true;
  joint.lower = -0.1;
  joint.upper = 0.1;
  joint.damping = 0.5;
  Lab lab(b.model);
  lab.run_ticks(2000);
  EXPECT_NEAR(lab.joint("hinge").position, 0.1, 1e-5);
  for (const double compliance : {1e-13, 1e-11, 0.0}) {
    lab.drive("hinge") = {-1e-3, compliance, 100.0, 0.0};
    lab.run_ticks(50);
    EXPECT_NEAR(lab.joint("hinge").effort, -4.0 * 9.80665 * 0.25 * std::cos(0.1), 0.01) << compliance;
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
