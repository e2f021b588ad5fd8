// One engine goes on where another one has stopped: "each time with whatever state it is given" (engine.h).
#include <algorithm>

#include "tests/dynamics/contract/rows.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::dynamics::testing {
namespace {

using Eigen::Vector3d;
using world::JointKind;

std::vector<Row> hand_over_rows() {
  std::vector<Row> all = rows();
  Row order6 = *std::ranges::find(all, "ImpulseOrder4", &Row::name);
  order6.name = "ImpulseOrder6";
  order6.engine.order = 6;
  all.push_back(order6);
  return all;
}

// A double pendulum, a lever whose end is on the ground, a crate that stands, and a ball that rolls.
world::WorldModel handed_model(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  b.add_ground();
  const BodyId upper = b.add_box("upper", {0.5, 0.05, 0.05}, 1.0, at(0.25, 2, 1.5));
  const BodyId lower = b.add_box("lower", {0.5, 0.05, 0.05}, 1.0, at(0.75, 2, 1.5));
  b.add_joint("shoulder", JointKind::kHinge, {}, upper, {0, 2, 1.5}, Vector3d::UnitY());
  b.add_joint("elbow", JointKind::kHinge, upper, lower, {0.5, 2, 1.5}, Vector3d::UnitY());
  const BodyId arm = b.add_box("arm", {0.6, 0.04, 0.04}, 1.0, at(0.3, -2, 0.05));
  const BodyId foot = b.add_sphere("foot", 0.05, 0.5, at(0.6, -2, 0.05));
  b.add_joint("pivot", JointKind::kHinge, {}, arm, {0, -2, 0.05}, Vector3d::UnitY());
  b.add_joint("ankle", JointKind::kFixed, arm, foot, {0.6, -2, 0.05}, Vector3d::UnitZ());
  b.add_box("crate", {0.2, 0.2, 0.2}, 2.0, at(-1, 0, 0.1));
  const BodyId ball = b.add_sphere("ball", 0.1, 1.0, at(-1, 1, 0.1));
  b.body(ball).v_WB = {1.0, 0.0, 0.0};
  b.body(ball).w_WB = {0.0, 10.0, 0.0};
  return b.model;
}

using Pair = std::tuple<Row, Row>;

class HandOver : public ::testing::TestWithParam<Pair> {
 protected:
  static constexpr int kBefore = 300, kAfter = 200;

  const Row& first() const { return std::get<0>(GetParam()); }
  const Row& second() const { return std::get<1>(GetParam()); }

  void expect_to_go_on(const world::WorldState& from, Lab& straight) const;
};
INSTANTIATE_TEST_SUITE_P(Engines, HandOver,
                         ::testing::Combine(::testing::ValuesIn(hand_over_rows()),
                                            ::testing::ValuesIn(hand_over_rows())),
                         [](const auto& info) {
                           return std::get<0>(info.param).name + "To" + std::get<1>(info.param).name;
                         });

double largest_step(const Lab& lab, const world::WorldState& before) {
  double largest = 0.0;
  for (std::size_t i = 0; i < before.bodies.size(); ++i) {
    const auto &was = before.bodies[i], &is = lab.state.bodies[i];
    largest = std::max(largest, (is.p_WC - was.p_WC - lab.tick_s() * was.v_WC).norm());
  }
  return largest;
}

double farthest_apart(const Lab& a, const Lab& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.state.bodies.size(); ++i)
    largest = std::max(largest, (a.state.bodies[i].p_WC - b.state.bodies[i].p_WC).norm());
  return largest;
}

// The engine that goes straight on is the reference; ODE misses a parabola by 0.2 mm in that time.
void HandOver::expect_to_go_on(const world::WorldState& from, Lab& straight) const {
  Lab lab(handed_model(second().engine));
  lab.state = from;
  // Closing a gap and an overlap that ODE leaves costs a millijoule.
  const double energy = physics::energy_of(lab.model, lab.state);
  const double drift = 2e-3 + second().accuracy.pendulum_energy * physics::energy_scale(lab.model);
  for (int i = 0; i < kAfter; ++i) {
    const world::WorldState before = lab.state;
    const StepResult result = lab.step();
    ASSERT_TRUE(result.ok) << result.fault;
    ASSERT_LT(largest_step(lab, before), 1e-4) << i;
    ASSERT_NEAR(physics::energy_of(lab.model, lab.state), energy, drift) << i;
    ASSERT_LT(physics::max_gap(lab.model, lab.state), second().accuracy.joint_gap_m) << i;
  }
  EXPECT_LT(farthest_apart(lab, straight), 1e-3);
}

TEST_P(HandOver, GoesOnFromTheBodiesAndJointsOfAnotherEngine) {
  Lab straight(handed_model(first().engine));
  straight.run_ticks(kBefore);
  const world::WorldState with_its_bytes = straight.state;
  world::WorldState without = with_its_bytes;
  for (auto& kept : without.engines) kept.clear();
  straight.run_ticks(kAfter);
  expect_to_go_on(without, straight);
  expect_to_go_on(with_its_bytes, straight);
}

}  // namespace
}  // namespace visum::dynamics::testing
