// Bodies and joints that are put elsewhere: what hangs on them comes along, with its motion.
#include "server/world/placing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/world/model.h"

namespace visum::world {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::HasSubstr;

Body free_body(const std::string& name, const Vector3d& at) {
  Body body;
  body.name = name;
  body.mass_kg = 1.0;
  body.inertia_C = Eigen::Matrix3d::Identity();
  body.p_BC = {0.05, -0.02, 0.03};
  body.X_WB.p = at;
  return body;
}

Joint hinge(const std::string& name, int parent, int child, const Vector3d& at_parent,
            const Vector3d& at_child) {
  Joint joint;
  joint.name = name;
  joint.parent = {parent};
  joint.child = {child};
  joint.X_PJ.p = at_parent;
  joint.X_CJ.p = at_child;
  return joint;
}

// A trunk, an arm on it, a hand on the arm, and a body that hangs on nothing.
WorldModel chain() {
  WorldModel model;
  model.engines.emplace_back();
  model.surfaces.emplace_back();
  model.bodies = {free_body("trunk", {0, 0, 1}), free_body("arm", {0.2, 0, 1}),
                  free_body("hand", {0.6, 0, 1}), free_body("box", {2, 0, 0})};
  model.joints = {hinge("shoulder", 0, 1, {0.1, 0, 0}, {-0.1, 0, 0}),
                  hinge("wrist", 1, 2, {0.2, 0, 0}, {-0.2, 0, 0})};
  model.joints[1].axis_J = Vector3d::UnitY();
  model.joints[1].limited = true;
  model.joints[1].lower = -1.0;
  model.joints[1].upper = 1.0;
  EXPECT_EQ(find_fault(model), "");
  return model;
}

// The velocities of a state agree with where a small step along them leads.
void expect_consistent(const WorldModel& model, const WorldState& state) {
  constexpr double h = 1e-6;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    WorldState later = state;
    for (auto& body : later.bodies) {
      body.p_WC += h * body.v_WC;
      const Vector3d turn = 0.5 * h * body.w_WB;
      body.q_WB = (Quaterniond(1.0, turn.x(), turn.y(), turn.z()) * body.q_WB).normalized();
    }
    measure_joints(model, later, h);
    EXPECT_NEAR((later.joints[j].position - state.joints[j].position) / h, state.joints[j].velocity, 1e-5);
    const Joint& joint = model.joints[j];
    const auto at = [&](const WorldState& of, BodyId id, const Pose& X_BJ) {
      return (link_pose(model.bodies[id.index()], of.bodies[id.index()]) * X_BJ).p;
    };
    EXPECT_LT((at(later, joint.parent, joint.X_PJ) - at(later, joint.child, joint.X_CJ)).norm(), 1e-10)
        << joint.name << " stays together";
  }
}

TEST(Placing, ABodyTakesAlongWhatHangsOnIt) {
  const auto model = chain();
  auto state = initial_state(model);
  const JointPlacement bent[] = {{{0}, 0.4, 0.3}, {{1}, -0.5, 0.7}};
  place_joints(model, bent, state);
  const auto before = state;
  const Placement to{{{1, 2, 3}, Quaterniond(0.8, 0.0, 0.6, 0.0)}, {0.5, 0, 0.1}, {0, 0.2, 0.4}};
  ASSERT_EQ(placing_fault(model, BodyId{0}), "");
  place_body(model, {0}, to, state);
  EXPECT_LT((link_pose(model.bodies[0], state.bodies[0]).p - Vector3d(1, 2, 3)).norm(), 1e-12);
  for (const std::size_t j : {0u, 1u}) {
    EXPECT_NEAR(state.joints[j].position, before.joints[j].position, 1e-12);
    EXPECT_NEAR(state.joints[j].velocity, before.joints[j].velocity, 1e-12);
  }
  EXPECT_EQ(state.bodies[3].p_WC, before.bodies[3].p_WC) << "the box hangs on nothing";
  expect_consistent(model, state);
}

TEST(Placing, JointsGoWhereTheyAreSetAndTakeAlongWhatHangsOnThem) {
  const auto model = chain();
  auto state = initial_state(model);
  const JointPlacement to[] = {{{1}, 0.9, -1.5}, {{0}, 7.0, 2.0}};
  for (const auto& joint : to) ASSERT_EQ(placing_fault(model, joint), "");
  place_joints(model, to, state);
  EXPECT_NEAR(state.joints[0].position, 7.0, 1e-12) << "more than a turn";
  EXPECT_NEAR(state.joints[0].velocity, 2.0, 1e-12);
  EXPECT_NEAR(state.joints[1].position, 0.9, 1e-12);
  EXPECT_NEAR(state.joints[1].velocity, -1.5, 1e-12);
  EXPECT_EQ(state.bodies[0].p_WC, initial_state(model).bodies[0].p_WC) << "the trunk stays";
  expect_consistent(model, state);
}

TEST(Placing, WhatCannotBePutElsewhereIsNamed) {
  auto model = chain();
  EXPECT_THAT(placing_fault(model, BodyId{2}), HasSubstr("'hand' hangs on the joint 'wrist'"));
  EXPECT_THAT(placing_fault(model, JointPlacement{{1}, 1.2, 0.0}), HasSubstr("from -1.0"));
  EXPECT_THAT(placing_fault(model, JointPlacement{{1}, NAN, 0.0}), HasSubstr("not finite"));
  model.joints.push_back(hinge("loop", 0, 2, {0.6, 0, 0}, {0, 0, 0}));
  EXPECT_THAT(placing_fault(model, JointPlacement{{0}, 0.1, 0.0}),
              HasSubstr("in a loop, which 'loop' closes"));
  model.joints.back() = hinge("string", 0, 3, {0, 0, 0}, {0, 0, 0});
  model.joints.back().kind = JointKind::kPointOnPlane;
  EXPECT_THAT(placing_fault(model, BodyId{0}), HasSubstr("the joint 'string' holds 'trunk'"));
  model.bodies[3].fixed = true;
  EXPECT_THAT(placing_fault(model, BodyId{3}), HasSubstr("'box' is fixed"));
}

TEST(Placing, AKinematicChainKeepsItsJointsTogetherForever) {
  auto model = chain();
  for (auto& body : model.bodies) body.kinematic = true, body.engine = kNoEngine;
  ASSERT_EQ(find_fault(model), "");
  const auto tree = kinematic_tree(model);
  ASSERT_EQ(tree.roots.size(), 2u);
  auto state = initial_state(model);
  place_body(model, {0}, {model.bodies[0].X_WB, {0.1, 0, 0}, {0.3, 0.2, 1.0}}, state);
  const JointPlacement turning[] = {{{0}, 0.0, 1.0}, {{1}, 0.0, 0.25}};
  place_joints(model, turning, state);
  for (int i = 0; i < 3000; ++i) {
    const auto before = state;
    move_kinematic(model, tree, 1e-3, before, state);
    measure_joints(model, state, 1e-3);
  }
  EXPECT_NEAR(state.joints[0].position, 3.0, 1e-8);
  EXPECT_NEAR(state.joints[1].position, 0.75, 1e-8);
  expect_consistent(model, state);
}

}  // namespace
}  // namespace visum::world
