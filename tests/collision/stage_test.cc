// The stage as a whole: order, purity, pairs that never collide, surfaces, caps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "server/collision/shapes.h"
#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;
const ShapeSpec kCube{kBox, {1, 1, 1}};

// A heap of all kinds of shapes, thrown together with a seed.
SceneBuilder make_heap(unsigned seed, int count) {
  SceneBuilder scene;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1.5, 1.5), angle(-3.0, 3.0);
  const std::vector<ShapeSpec> kinds{kCube,
                                     {kSphere, {0.5}},
                                     {kCylinder, {0.4, 1.0}},
                                     {kCapsule, {0.3, 0.8}},
                                     {kConvex, {1, 0.7, 0.5}},
                                     {kMesh, {0.8, 1, 0.6}}};
  scene.add({kPlane, {}}, at(0, 0, -0.8));
  for (int i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), z = place(random), turn = angle(random);
    scene.add(kinds[static_cast<std::size_t>(i) % kinds.size()], at(x, y, z, turn, {1, x, y}));
  }
  return scene;
}

bool same_bits(const Contact& a, const Contact& b) {
  return a.shape_a == b.shape_a && a.shape_b == b.shape_b && a.body_a == b.body_a && a.body_b == b.body_b &&
         a.feature == b.feature && a.p_W == b.p_W && a.normal_W == b.normal_W && a.depth == b.depth &&
         a.friction == b.friction && a.restitution == b.restitution;
}

bool same_bits(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Contact& x, const Contact& y) { return same_bits(x, y); });
}

TEST(CollisionStage, ContactsAreSortedAndSoundInEveryHeap) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    const SceneBuilder scene = make_heap(seed, 18);
    const auto contacts = contacts_of(scene.model);
    EXPECT_FALSE(contacts.empty());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Contact& c = contacts[i];
      EXPECT_LT(c.shape_a, c.shape_b);
      EXPECT_EQ(c.body_a, scene.model.shapes[c.shape_a.index()].body);
      EXPECT_EQ(c.body_b, scene.model.shapes[c.shape_b.index()].body);
      EXPECT_GT(c.depth, 0.0);
      EXPECT_LT(c.depth, 3.0);
      EXPECT_NEAR(c.normal_W.norm(), 1.0, 1e-9);
      EXPECT_TRUE(c.p_W.allFinite());
      EXPECT_LT(static_cast<std::size_t>(c.feature), kMaxContactsPerPair);
      if (i == 0) continue;
      const Contact& p = contacts[i - 1];
      EXPECT_LT(std::tie(p.shape_a, p.shape_b, p.feature), std::tie(c.shape_a, c.shape_b, c.feature));
    }
  }
}

double deepest(const std::vector<Contact>& contacts) {
  double depth = 0.0;
  for (const Contact& contact : contacts) depth = std::max(depth, contact.depth);
  return depth;
}

// The normal's promise: pushed along it by the depth of the deepest point (and a hair), two convex shapes are
// apart. It takes a few pushes if the deepest part lies beside the face that pushes, or between the corners
// that stand for a rim.
TEST(CollisionStage, PushingAlongTheNormalSeparatesTwoConvexShapes) {
  const std::vector<ShapeSpec> kinds{
      kCube, {kSphere, {0.5}}, {kCylinder, {0.4, 1.0}}, {kCapsule, {0.3, 0.8}}, {kConvex, {1, 0.7, 0.5}}};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.8, 0.8), angle(-3.0, 3.0);
  int touching = 0, more_than_once = 0;
  for (int i = 0; i < 4000; ++i) {
    const ShapeSpec& a = kinds[static_cast<std::size_t>(i) % 5];
    const ShapeSpec& b = kinds[static_cast<std::size_t>(i / 5) % 5];
    const double x = place(random), y = place(random), z = place(random), turn = angle(random);
    Pose X_WA = at(x, y, z, turn, {1, y, x});
    const Pose X_WB = at(0, 0, 0, angle(random), {x, 1, z});
    int pushes = 0;
    for (auto contacts = contacts_between(a, X_WA, b, X_WB); !contacts.empty() && pushes < 10; ++pushes) {
      X_WA.p += contacts.front().normal_W * (deepest(contacts) + 1e-5);
      contacts = contacts_between(a, X_WA, b, X_WB);
    }
    EXPECT_LT(pushes, 10) << "pair " << i;
    touching += pushes > 0 ? 1 : 0;
    more_than_once += pushes > 1 ? 1 : 0;
  }
  EXPECT_GT(touching, 1000);
  EXPECT_LT(more_than_once, touching / 10);
}

TEST(CollisionStage, FindsThePairsThatTestingAllPairsFinds) {
  for (unsigned seed = 100; seed < 110; ++seed) {
    const SceneBuilder scene = make_heap(seed, 12);
    std::set<std::pair<std::int32_t, std::int32_t>> found, expected;
    for (const Contact& c : contacts_of(scene.model)) found.insert({c.shape_a.value, c.shape_b.value});
    for (std::size_t i = 0; i < scene.model.shapes.size(); ++i) {
      for (std::size_t j = i + 1; j < scene.model.shapes.size(); ++j) {
        world::WorldModel pair = scene.model;
        for (std::size_t k = 0; k < pair.shapes.size(); ++k) pair.shapes[k].collides = k == i || k == j;
        if (!contacts_of(pair).empty())
          expected.insert({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
      }
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(CollisionStage, IsAFunctionOfThePosesAlone) {
  const SceneBuilder scene = make_heap(7, 18);
  const world::WorldState start = initial_state(scene.model);
  CollisionStage stage(scene.model);
  std::vector<Contact> first, again;
  stage.find(start, first);
  world::WorldState moved = start;
  for (int i = 0; i < 20; ++i) {
    for (world::BodyState& body : moved.bodies) body.p_WC = -0.9 * body.p_WC + Eigen::Vector3d(0.1, 0.05, 0);
    stage.find(moved, again);
  }
  stage.find(start, again);
  EXPECT_TRUE(same_bits(first, again));
  EXPECT_TRUE(same_bits(first, contacts_of(scene.model))) << "a fresh stage finds the same";
}

// From creeping to leaping, turning and coming back. Whatever a stage keeps of earlier calls saves work and
// changes nothing.
TEST(CollisionStage, FindsOnItsWayWhatAFreshStageFinds) {
  std::size_t touching = 0;
  for (const double speed : {1e-5, 1e-3, 2e-2, 0.3}) {
    const SceneBuilder scene = make_heap(11, 18);
    world::WorldState state = initial_state(scene.model);
    CollisionStage stage(scene.model);
    std::mt19937 random(static_cast<unsigned>(1e5 * speed));
    std::uniform_real_distribution<double> away(-1.0, 1.0);
    for (int i = 0; i < 60; ++i) {
      for (std::size_t k = 1; k < state.bodies.size(); ++k) {
        world::BodyState& body = state.bodies[k];
        if (k % 3 == static_cast<std::size_t>(i / 5) % 3) continue;  // stands for five calls
        body.p_WC += speed * (Eigen::Vector3d(away(random), away(random), away(random)) - 0.2 * body.p_WC);
        const Eigen::Quaterniond turn(1.0, speed * away(random), speed * away(random), speed * away(random));
        body.q_WB = (turn * body.q_WB).normalized();
      }
      CollisionStage fresh(scene.model);
      std::vector<Contact> on_its_way, anew;
      stage.find(state, on_its_way);
      fresh.find(state, anew);
      ASSERT_TRUE(same_bits(on_its_way, anew)) << "speed " << speed << ", call " << i;
      touching += anew.size();
    }
  }
  EXPECT_GT(touching, 1000u);
}

// Nor does a stage mix up what it keeps of pairs that stand while others come, go and come back to where they
// were, and while it looks ahead.
TEST(CollisionStage, FindsOfPairsThatStandWhatAFreshStageFinds) {
  const SceneBuilder scene = make_heap(12, 18);
  const world::WorldState start = initial_state(scene.model);
  world::WorldState state = start;
  CollisionStage stage(scene.model);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> away(-1.0, 1.0);
  std::size_t kept = 0;
  for (int i = 0; i < 200; ++i) {
    const world::WorldState before = state;
    for (std::size_t k = 1; k < state.bodies.size(); ++k) {
      if (random() % 4 != 0) continue;
      if (random() % 2 == 0)
        state.bodies[k] = start.bodies[k];
      else
        state.bodies[k].p_WC += 0.2 * Eigen::Vector3d(away(random), away(random), away(random));
    }
    std::vector<Contact> found, anew, ahead;
    if (i % 3 == 0) stage.foresee(before, state, &ahead);
    CollisionStage fresh(scene.model);
    ASSERT_EQ(stage.find(state, found), fresh.find(state, anew));
    ASSERT_TRUE(same_bits(found, anew)) << "call " << i;
    kept += fresh.tested() - stage.tested();
  }
  EXPECT_GT(kept, 500u);
}

TEST(CollisionStage, TestsNothingAnewThatStands) {
  SceneBuilder scene;
  scene.add({kPlane, {}}, {});
  for (int i = 0; i < 5; ++i) scene.add(kCube, at(0, 0, 0.499 + 0.999 * i));
  world::WorldState state = initial_state(scene.model);
  CollisionStage stage(scene.model);
  std::vector<Contact> contacts;
  stage.find(state, contacts);
  EXPECT_EQ(stage.tested(), 5u);
  stage.find(state, contacts);
  EXPECT_EQ(stage.tested(), 0u);
  EXPECT_EQ(contacts.size(), 20u);
  state.bodies[5].p_WC.x() += 1e-16;
  stage.find(state, contacts);
  EXPECT_EQ(stage.tested(), 1u);
}

TEST(CollisionStage, VelocitiesDoNotMatter) {
  const SceneBuilder scene = make_heap(8, 12);
  world::WorldState state = initial_state(scene.model);
  for (world::BodyState& body : state.bodies) body.v_WC = {5, 6, 7};
  CollisionStage stage(scene.model);
  std::vector<Contact> contacts;
  stage.find(state, contacts);
  EXPECT_TRUE(same_bits(contacts, contacts_of(scene.model)));
}

TEST(CollisionStage, FixedBodiesNeverCollideWithEachOther) {
  SceneBuilder scene;
  scene.add({kPlane, {}}, {});
  scene.add_fixed(kCube, {});
  scene.add_fixed(kCube, at(0.5, 0, 0));
  EXPECT_TRUE(contacts_of(scene.model).empty());
}

TEST(CollisionStage, PairsNamedInNoCollisionNeverCollide) {
  SceneBuilder scene;
  scene.add(kCube, {});
  scene.add(kCube, at(0.5, 0, 0));
  EXPECT_FALSE(contacts_of(scene.model).empty());
  scene.model.no_collision = {{{0}, {1}}};
  EXPECT_TRUE(contacts_of(scene.model).empty());
}

TEST(CollisionStage, BodiesOfOneJointNeverCollide) {
  SceneBuilder scene;
  scene.add(kCube, {});
  scene.add(kCube, at(0.5, 0, 0));
  world::Joint joint;
  joint.name = "joint";
  joint.parent = {1};
  joint.child = {0};
  scene.model.joints.push_back(joint);
  EXPECT_TRUE(contacts_of(scene.model).empty());
}

TEST(CollisionStage, BodiesThatASpringJoinsDoCollide) {
  SceneBuilder scene;
  scene.add(kCube, {});
  scene.add(kCube, at(0.5, 0, 0));
  for (const auto kind : {world::JointKind::kSpring, world::JointKind::kTorsionSpring}) {
    world::Joint spring;
    spring.name = "spring";
    spring.kind = kind;
    spring.parent = {1};
    spring.child = {0};
    scene.model.joints = {spring};
    EXPECT_FALSE(contacts_of(scene.model).empty());
  }
}

TEST(CollisionStage, ShapesOfOneMeshHaveOneTree) {
  SceneBuilder scene;
  scene.add({kMesh, {1, 1, 1}}, {});
  scene.add({kMesh, {1, 1, 1}}, at(5, 0, 0));
  scene.add({kMesh, {2, 1, 1}}, at(9, 0, 0));
  scene.model.shapes[1].mesh = scene.model.shapes[0].mesh;
  PreparedMeshes meshes;
  const auto shapes = prepare_shapes(scene.model, meshes);
  EXPECT_EQ(shapes[0].mesh, shapes[1].mesh);
  EXPECT_NE(shapes[0].mesh, shapes[2].mesh);
}

TEST(CollisionStage, StagesOfOneWorldShareMeshesAndHulls) {
  SceneBuilder scene;
  scene.add({kMesh, {1, 1, 1}}, {});
  scene.add({kConvex, {1, 0.7, 0.5}}, at(5, 0, 0));
  SceneBuilder equal = scene;
  equal.model.meshes[0].name = "another name";
  SceneBuilder other = scene;
  other.model.meshes[0].vertices[0].x() += 1e-9;
  other.model.meshes[1].vertices[0].x() += 1e-9;
  PreparedMeshes meshes;
  auto shapes = prepare_shapes(scene.model, meshes);
  for (const auto& [model, is_shared] : {std::pair{&equal.model, true}, {&other.model, false}}) {
    const auto again = prepare_shapes(*model, meshes);
    EXPECT_EQ(again[0].mesh == shapes[0].mesh, is_shared);
    EXPECT_EQ(again[1].solid == shapes[1].solid, is_shared);
  }
  const std::weak_ptr<const Mesh> mesh = shapes[0].mesh;
  const std::weak_ptr<const Solid> hull = shapes[1].solid;
  meshes.forget_unused();
  EXPECT_EQ(prepare_shapes(scene.model, meshes)[1].solid, shapes[1].solid) << "they are in use";
  shapes.clear();
  EXPECT_FALSE(mesh.expired());
  meshes.forget_unused();
  EXPECT_TRUE(mesh.expired());
  EXPECT_TRUE(hull.expired());
}

void expect_same(const Polytope& a, const Polytope& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.corners, b.corners);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.faces_of, b.faces_of);
  EXPECT_TRUE(std::ranges::equal(a.faces, b.faces, [](const auto& x, const auto& y) {
    return x.normal == y.normal && x.first == y.first && x.count == y.count;
  }));
}

// With the order in which the trees are visited.
void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_TRUE(std::ranges::equal(a.triangles(), b.triangles(), [](const auto& x, const auto& y) {
    return x.corners == y.corners && x.normal == y.normal && x.across == y.across;
  }));
  const auto visited = [](const Mesh& mesh) {
    std::vector<std::uint32_t> order;
    std::vector<Eigen::Vector3d> boxes;
    mesh.visit(
        [&](const Eigen::AlignedBox3d& box) {
          boxes.insert(boxes.end(), {box.min(), box.max()});
          return box.min().x() < 0.01;
        },
        [&](std::uint32_t i) { order.push_back(i); });
    return std::pair(order, boxes);
  };
  EXPECT_EQ(visited(a), visited(b));
}

TEST(CollisionStage, ManyMeshesArePreparedAsOneAfterTheOther) {
  SceneBuilder scene;
  for (int i = 1; i <= 20; ++i) scene.add({i % 2 ? kConvex : kMesh, {1, 1, 0.1 * i}}, at(5 * i, 0, 0));
  scene.add_fixed({kPlane}, {});
  scene.model.shapes[4].collides = false;
  PreparedMeshes meshes;
  const auto shapes = prepare_shapes(scene.model, meshes);
  EXPECT_EQ(meshes.count(), 19u);
  for (const PreparedShape& shape : shapes) {
    SceneBuilder alone = scene;
    alone.model.shapes = {scene.model.shapes[shape.id.index()]};
    PreparedMeshes own;
    const PreparedShape one = prepare_shapes(alone.model, own)[0];
    EXPECT_EQ(one.box_S.min(), shape.box_S.min());
    EXPECT_EQ(one.box_S.max(), shape.box_S.max());
    if (shape.kind == kConvex) expect_same(one.solid->convex.polytope, shape.solid->convex.polytope);
    if (shape.kind == kMesh) expect_same(*one.mesh, *shape.mesh);
  }
}

TEST(CollisionStage, WhatIsPreparedOrEqualIsNotPreparedAgain) {
  SceneBuilder scene;
  for (int i = 0; i < 40; ++i) scene.add({kConvex, {1, 0.7, 0.5}}, at(5 * i, 0, 0));
  scene.add({kConvex, {1, 1, 1}}, at(0, 5, 0));
  std::vector<const world::TriangleMesh*> wanted;
  for (const world::TriangleMesh& mesh : scene.model.meshes) wanted.push_back(&mesh);
  ASSERT_EQ(wanted.size(), 41u);
  PreparedMeshes meshes;
  EXPECT_EQ(meshes.without_hull(wanted), (std::vector{wanted[0], wanted[40]}));
  meshes.hull(*wanted[7]);
  EXPECT_EQ(meshes.without_hull(wanted), (std::vector{wanted[40]}));
  EXPECT_EQ(meshes.without_tree(wanted), (std::vector{wanted[0], wanted[40]})) << "a hull is no tree";
  prepare_shapes(scene.model, meshes);
  EXPECT_EQ(meshes.count(), 2u);
}

TEST(CollisionStage, AHullWithoutVolumeIsRefusedEachTime) {
  for (const int count : {1, 10}) {
    SceneBuilder scene;
    for (int i = 1; i <= count; ++i) scene.add({kConvex, {1, 1, 0.1 * i}}, at(5 * i, 0, 0));
    for (auto& vertex : scene.model.meshes.back().vertices) vertex.z() = 0.0;
    PreparedMeshes meshes;
    for (int i = 0; i < 2; ++i) EXPECT_THROW(prepare_shapes(scene.model, meshes), std::runtime_error);
  }
}

TEST(CollisionStage, ShapesOnlyToBeLookedAtDoNotCollide) {
  SceneBuilder scene;
  scene.add(kCube, {});
  scene.add(kCube, at(0.5, 0, 0));
  scene.model.shapes[1].collides = false;
  EXPECT_TRUE(contacts_of(scene.model).empty());
}

TEST(CollisionStage, ShapesOfOneBodyDoNotCollide) {
  SceneBuilder scene;
  scene.add(kCube, {});
  scene.model.shapes.push_back(scene.model.shapes[0]);
  EXPECT_TRUE(contacts_of(scene.model).empty());
}

TEST(CollisionStage, FrictionIsTheGeometricMeanAndRestitutionTheLarger) {
  SceneBuilder scene;
  scene.add(kCube, {});
  scene.add(kCube, at(0, 0, 0.99));
  scene.model.surfaces = {{"rough", 0.9, 0.1}, {"smooth", 0.4, 0.3}};
  scene.model.shapes[1].surface = {1};
  const auto contacts = contacts_of(scene.model);
  ASSERT_FALSE(contacts.empty());
  EXPECT_DOUBLE_EQ(contacts[0].friction, 0.6);
  EXPECT_DOUBLE_EQ(contacts[0].restitution, 0.3);
}

TEST(CollisionStage, AShapesOwnPoseCounts) {
  SceneBuilder scene;
  scene.add(kCube, {});
  scene.add(kCube, at(5, 0, 0));
  EXPECT_TRUE(contacts_of(scene.model).empty());
  scene.model.shapes[1].X_BS.p.x() = -4.01;
  ASSERT_FALSE(contacts_of(scene.model).empty());
  EXPECT_NEAR(contacts_of(scene.model)[0].depth, 0.01, 1e-12);
}

TEST(CollisionStage, ABodyWhoseStateIsNotFiniteMeetsNothingAndOthersGoOn) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const ShapeSpec& kind : {kCube, ShapeSpec{kCylinder, {0.5, 1}}, ShapeSpec{kMesh, {1, 1, 1}}}) {
      SceneBuilder scene;
      scene.add({kPlane, {}}, {});
      scene.add(kind, at(0, 0, 0.4));
      scene.add(kCube, at(3, 0, 0.4));
      CollisionStage stage(scene.model);
      world::WorldState state = initial_state(scene.model);
      state.bodies[1].p_WC.y() = bad;
      std::vector<Contact> contacts;
      stage.find(state, contacts);
      EXPECT_EQ(contacts.size(), 4u);
      state.bodies[1].p_WC.y() = 0.0;
      state.bodies[1].q_WB.x() = bad;
      stage.find(state, contacts);
      EXPECT_EQ(contacts.size(), 4u);
      state.bodies[0].p_WC.z() = bad;  // the ground
      stage.find(state, contacts);
      EXPECT_TRUE(contacts.empty());
    }
  }
}

TEST(CollisionStage, NoMoreThanTheCapIsEverFound) {
  SceneBuilder scene;
  for (int i = 0; i < 150; ++i) scene.add(kCube, at(1e-3 * i, 2e-3 * i, 0));
  CollisionStage stage(scene.model);
  std::vector<Contact> contacts;
  EXPECT_FALSE(stage.find(initial_state(scene.model), contacts)) << "and it says so";
  EXPECT_EQ(contacts.size(), kMaxContacts);
}

}  // namespace
}  // namespace visum::collision::testing
