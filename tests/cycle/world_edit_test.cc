#include "server/cycle/world_edit.h"

#include <gtest/gtest.h>

namespace visum::cycle {
namespace {

using world::BodyId;

// Bodies a, b, c; a shape on each; b and c joined.
world::WorldModel three_bodies() {
  world::WorldModel model;
  for (int i = 0; i < 3; ++i) {
    model.bodies.push_back({.name = std::string(1, static_cast<char>('a' + i))});
    model.shapes.push_back({.body = BodyId{i}});
  }
  model.joints.push_back({.name = "hinge", .parent = BodyId{1}, .child = BodyId{2}});
  model.no_collision = {{BodyId{0}, BodyId{1}}, {BodyId{1}, BodyId{2}}};
  return model;
}

TEST(WorldEdit, ClosesTheGapInEverythingThatCountsByNumber) {
  auto model = three_bodies();
  erase_body(model, BodyId{0});
  ASSERT_EQ(model.bodies.size(), 2u);
  EXPECT_EQ(model.bodies[0].name, "b");
  ASSERT_EQ(model.shapes.size(), 2u);
  EXPECT_EQ(model.shapes[0].body, BodyId{0});
  EXPECT_EQ(model.shapes[1].body, BodyId{1});
  EXPECT_EQ(model.joints[0].parent, BodyId{0});
  EXPECT_EQ(model.joints[0].child, BodyId{1});
  ASSERT_EQ(model.no_collision.size(), 1u);
  EXPECT_EQ(model.no_collision[0], std::pair(BodyId{0}, BodyId{1}));
}

TEST(WorldEdit, MeshesThatNothingUsesAnyMoreGo) {
  auto model = three_bodies();
  for (const char* name : {"first", "shared", "last"}) model.meshes.push_back({.name = name});
  model.shapes[0].mesh = {0};
  model.shapes.push_back({.body = BodyId{0}, .mesh = {1}});
  model.shapes[1].mesh = {1};
  model.shapes[2].mesh = {2};
  erase_body(model, BodyId{0});
  ASSERT_EQ(model.meshes.size(), 2u);
  EXPECT_EQ(model.meshes[0].name, "shared");
  ASSERT_EQ(model.shapes.size(), 2u);
  EXPECT_EQ(model.shapes[0].mesh, world::MeshId{0});
  EXPECT_EQ(model.shapes[1].mesh, world::MeshId{1});
}

TEST(WorldEdit, AWorldJointKeepsItsNoParent) {
  auto model = three_bodies();
  model.joints[0].parent = BodyId{};
  erase_body(model, BodyId{0});
  EXPECT_FALSE(model.joints[0].parent.valid());
}

TEST(WorldEdit, WhatAJointHoldsOrAModelOwnsStays) {
  auto model = three_bodies();
  EXPECT_TRUE(can_remove(model, BodyId{0}).done());
  EXPECT_EQ(can_remove(model, BodyId{1}).refusal(), Refusal::kWrongState);
  EXPECT_EQ(can_remove(model, BodyId{1}).text(), "the joint 'hinge' holds 'b'");
  model.bodies[0].model = "arm";
  EXPECT_EQ(can_remove(model, BodyId{0}).text(), "'a' belongs to a model");
}

}  // namespace
}  // namespace visum::cycle
