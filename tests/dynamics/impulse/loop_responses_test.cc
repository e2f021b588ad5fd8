// The response of impulses to each other on a mechanism with loops, found from their ways through the tree,
// against the mechanism's whole answer to each of them; and a body that stands on loops.
#include <gtest/gtest.h>

#include "server/dynamics/impulse/plant.h"
#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/legged_models.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::dynamics {
namespace {

using Eigen::Vector3d;
using impulse::Mechanism;
using impulse::PathMotion;

const world::EngineSetting kSetting = physics::engine_row("impulse").setting;

// Three impulses on each fourth body alone, and three between it and the one before it.
std::vector<PathMotion> some_lines(const Mechanism& mechanism) {
  std::vector<PathMotion> lines;
  const auto vector = [&](double seed) {
    return Vector3d(std::sin(seed), std::cos(2.0 * seed), std::sin(3.0 * seed));
  };
  for (std::size_t node = 0; node < mechanism.size(); node += 4)
    for (int i = 0; i < 6; ++i) {
      PathMotion& line = lines.emplace_back();
      const double seed = static_cast<double>(node) + 0.1 * i;
      line.node_a = static_cast<int>(node);
      line.angular_a = vector(seed);
      line.linear_a = vector(seed + 0.5);
      if (i < 3 || node == 0) continue;
      line.node_b = line.node_a - 1;
      line.angular_b = vector(seed + 0.7);
      line.linear_b = vector(seed + 0.9);
    }
  return lines;
}

Eigen::MatrixXd by_answers(Mechanism& mechanism, const std::vector<PathMotion>& lines) {
  const auto n = static_cast<Eigen::Index>(lines.size());
  Eigen::MatrixXd W(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    mechanism.clear();
    mechanism.push(lines[static_cast<std::size_t>(i)], 1.0);
    mechanism.solve();
    for (Eigen::Index j = 0; j < n; ++j) W(j, i) = mechanism.rate(lines[static_cast<std::size_t>(j)]);
  }
  return W;
}

Eigen::MatrixXd by_ways(Mechanism& mechanism, const std::vector<PathMotion>& lines) {
  impulse::Tree& tree = mechanism.tree();
  tree.begin_traces(lines.size());
  for (const PathMotion& line : lines) {
    const impulse::TreePush a = tree.push_at(line.node_a, line.angular_a, line.linear_a);
    const impulse::TreePush b = tree.push_at(line.node_b, line.angular_b, line.linear_b);
    tree.trace(std::span(&a, 1), std::span(&b, 1));
  }
  const auto n = static_cast<Eigen::Index>(lines.size());
  Eigen::MatrixXd W(n, n);
  tree.find_response(W.data());
  mechanism.hold_responses(lines.size(), W.data());
  return W;
}

// Four-bars that balls close: of each ball's three rows the tree cannot move the one in the middle.
world::WorldModel four_bars_with_balls() {
  world::WorldModel model = physics::four_bars(kSetting, 1e-3, 3);
  for (world::Joint& joint : model.joints)
    if (joint.name.starts_with("close")) joint.kind = world::JointKind::kBall;
  return model;
}

// In a plane, in space, and in legs under a free body.
TEST(LoopResponses, AreThoseOfTheWholeAnswer) {
  for (const world::WorldModel& model :
       {physics::four_bars(kSetting, 1e-3, 3), four_bars_with_balls(), physics::bricard(kSetting, 1e-3),
        physics::standing_linkages(kSetting, 1e-3, 1)}) {
    testing::Lab lab(model);
    lab.run_ticks(100);  // away from poses where every second number is zero
    impulse::Plant plant(model, 0);
    plant.bodies.load(lab.state);
    ASSERT_EQ(plant.mechanisms.size(), 1u);
    Mechanism& mechanism = plant.mechanisms[0];
    mechanism.place(plant.bodies, lab.state);
    mechanism.factor(plant.bodies);
    const std::vector<PathMotion> lines = some_lines(mechanism);
    const Eigen::MatrixXd whole = by_answers(mechanism, lines);
    EXPECT_GT(whole.norm(), 0.1);
    EXPECT_LT((by_ways(mechanism, lines) - whole).norm(), 1e-9 * whole.norm());
  }
}

TEST(LoopResponses, ATableStandsOnLinkages) {
  testing::Lab lab(physics::standing_linkages(kSetting, 1e-3, 1));
  const Vector3d start = lab.body("table_0").p_WC;
  lab.run_ticks(1000);
  EXPECT_LT((lab.body("table_0").p_WC - start).norm(), 1e-5);
  EXPECT_LT(lab.kinetic_energy(), 1e-12);
  EXPECT_LT(physics::max_gap(lab.model, lab.state), 2e-10);
  EXPECT_EQ(lab.warned_ticks, 0);
  double kg = 0.0, force = 0.0;
  for (const world::Body& body : lab.model.bodies)
    if (!body.fixed) kg += body.mass_kg;
  for (const char* leg : {"front_left", "front_right", "hind_left", "hind_right"})
    force += lab.normal_force_between("table_0_" + std::string(leg) + "_foot", "ground");
  EXPECT_NEAR(force, kg * lab.model.gravity.norm(), 1e-5 * force);
}

}  // namespace
}  // namespace visum::dynamics
