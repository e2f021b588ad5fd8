// Meshes that overlap ask for more work than a tick has. The limit counts it; a pair that meets the limit
// keeps contacts of a sample, and its bodies are named.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

constexpr std::uint64_t kLimit = 600'000;

// A ball with a bumpy surface, 0.2 m across: 2 * rows * columns triangles.
world::TriangleMesh bumpy_ball(std::uint32_t rows, std::uint32_t columns) {
  world::TriangleMesh mesh;
  mesh.name = "ball";
  for (std::uint32_t i = 0; i <= rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const double a = std::numbers::pi * i / rows, b = 2.0 * std::numbers::pi * j / columns;
      const double r = 0.1 + 0.005 * std::sin(17.0 * a) * std::cos(13.0 * b);
      mesh.vertices.push_back(
          r * Eigen::Vector3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
    }
  for (std::uint32_t i = 0; i < rows; ++i)
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t p = i * columns + j, q = i * columns + (j + 1) % columns;
      mesh.triangles.push_back({p, p + columns, q + columns});
      mesh.triangles.push_back({p, q + columns, q});
    }
  return mesh;
}

// Balls in one place, each a little beside the last.
world::WorldModel overlapping_balls(int count, std::uint64_t limit) {
  SceneBuilder scene;
  for (int i = 0; i < count; ++i)
    scene.add({ShapeKind::kMesh, {1, 1, 1}}, at(0.01 * i, 0.003 * i, 0, 0.3 * i, {1, 2, 3}));
  for (world::TriangleMesh& mesh : scene.model.meshes) mesh = bumpy_ball(60, 60);
  scene.model.collision_work_limit = limit;
  return scene.model;
}

TEST(MeshWork, OfOverlappingMeshesHasALimit) {
  const world::WorldModel model = overlapping_balls(4, kLimit), free = overlapping_balls(4, UINT64_MAX);
  CollisionStage stage(model), unlimited(free);
  std::vector<Contact> contacts, all;
  stage.find(initial_state(model), contacts);
  unlimited.find(initial_state(free), all);
  EXPECT_GT(unlimited.work(), 5 * kLimit) << "the case is no longer the one that is meant";
  EXPECT_TRUE(unlimited.limited().empty());
  // Each pair may pass its share by its last piece of work.
  EXPECT_LT(stage.work(), kLimit + kLimit / 4);
}

TEST(MeshWork, APairThatMeetsItsLimitKeepsContactsAndIsNamed) {
  const world::WorldModel model = overlapping_balls(4, kLimit);
  CollisionStage stage(model);
  std::vector<Contact> contacts;
  ASSERT_TRUE(stage.find(initial_state(model), contacts));
  std::vector<int> pairs(16, 0);
  for (const Contact& contact : contacts) {
    ++pairs[4 * contact.body_a.index() + contact.body_b.index()];
    EXPECT_GT(contact.depth, 0.0);
    EXPECT_NEAR(contact.normal_W.norm(), 1.0, 1e-9);
  }
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = a + 1; b < 4; ++b) EXPECT_GT(pairs[4 * a + b], 0) << a << " and " << b;
  EXPECT_EQ(stage.limited().size(), 4u);
}

// A stage leaves out pairs that cannot have met since it looked last. That must not change a share.
TEST(MeshWork, LimitedContactsDependOnThePosesAlone) {
  const world::WorldModel model = overlapping_balls(4, kLimit);
  world::WorldState state = initial_state(model);
  CollisionStage old(model);
  std::vector<Contact> contacts, fresh;
  for (int i = 0; i < 5; ++i) {
    state.bodies[3].p_WC.x() += 0.05;  // leaves the others one by one
    old.find(state, contacts);
    CollisionStage stage(model);
    stage.find(state, fresh);
    ASSERT_EQ(contacts.size(), fresh.size());
    for (std::size_t k = 0; k < fresh.size(); ++k) {
      EXPECT_EQ(contacts[k].p_W, fresh[k].p_W);
      EXPECT_EQ(contacts[k].depth, fresh[k].depth);
    }
    EXPECT_EQ(old.limited(), stage.limited());
    EXPECT_EQ(old.work(), stage.work());
  }
}

TEST(MeshWork, OfAMeshOnAPlaneOrInABoxHasALimitToo) {
  for (const ShapeSpec& other : {ShapeSpec{ShapeKind::kPlane}, ShapeSpec{ShapeKind::kBox, {1, 1, 1}}}) {
    SceneBuilder scene;
    scene.add_fixed(other, at(0, 0, other.kind == ShapeKind::kPlane ? 0.5 : 0.0));
    scene.add({ShapeKind::kMesh, {1, 1, 1}}, at(0, 0, 0));
    scene.model.meshes[0] = bumpy_ball(60, 60);
    scene.model.collision_work_limit = kLimit;
    CollisionStage stage(scene.model);
    std::vector<Contact> contacts;
    stage.find(initial_state(scene.model), contacts);
    EXPECT_FALSE(contacts.empty());
    EXPECT_FALSE(stage.limited().empty());
    EXPECT_LT(stage.work(), kLimit + kLimit / 4);
  }
}

}  // namespace
// A ball 1 cm beside a mesh, over the corner of its box, where a thousand of its triangles are.
TEST(MeshWork, OfAShapeBesideAMeshIsThatOfAFewTriangles) {
  SceneBuilder scene;
  scene.add_fixed({ShapeKind::kMesh, {1, 1, 1}}, at(0, 0, 0));
  scene.add({ShapeKind::kSphere, {0.1, 0, 0}}, at(0.125, 0.125, 0.125));
  scene.model.meshes[0] = bumpy_ball(60, 60);
  CollisionStage stage(scene.model);
  std::vector<Contact> contacts;
  stage.find(initial_state(scene.model), contacts);
  EXPECT_TRUE(contacts.empty());
  EXPECT_GT(stage.work(), 0u) << "their boxes do not meet";
  EXPECT_LT(stage.work(), 5'000u);
}

}  // namespace visum::collision::testing
