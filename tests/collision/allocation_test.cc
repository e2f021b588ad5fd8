// A warm tick of the collision stage allocates nothing of ours.
#include <gtest/gtest.h>

#include "tests/collision/scene.h"
#include "tests/support/allocation_counter.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;

TEST(Allocation, FindDoesNotAllocateOnceWarm) {
  SceneBuilder scene;
  scene.add({kPlane, {}}, {});
  const std::vector<ShapeSpec> kinds{{kBox, {1, 1, 1}},      {kSphere, {0.5}},       {kCylinder, {0.5, 1.0}},
                                     {kCapsule, {0.3, 0.8}}, {kConvex, {1, 1, 0.7}}, {kMesh, {1, 1, 1}}};
  for (int i = 0; i < 24; ++i)
    scene.add(kinds[static_cast<std::size_t>(i) % 6],
              at(0.6 * (i % 5), 0.7 * (i / 5), 0.4, 0.3 * i, {1, 2, 3}));
  CollisionStage stage(scene.model);
  world::WorldState state = initial_state(scene.model);
  std::vector<Contact> contacts;
  const auto shake = [&](double by) {
    for (std::size_t i = 1; i < state.bodies.size(); ++i) state.bodies[i].p_WC.z() += i % 2 == 0 ? by : -by;
  };
  for (int i = 0; i < 10; ++i) {
    shake(i % 2 == 0 ? 0.05 : -0.05);
    stage.find(state, contacts);
  }
  const test_support::AllocationScope scope;
  for (int i = 0; i < 100; ++i) {
    shake(i % 2 == 0 ? 0.05 : -0.05);
    stage.find(state, contacts);
  }
  EXPECT_EQ(scope.counts().ours, 0u) << scope.describe_ours();
  EXPECT_GT(contacts.size(), 30u);
}

TEST(Allocation, HoldBackDoesNotAllocateOnceWarm) {
  SceneBuilder scene;
  scene.add_fixed({kBox, {4, 4, 0.01}}, {});
  scene.add_fixed({kMesh, {4, 4, 0.01}}, at(0, 0, -1));
  for (const ShapeSpec& kind :
       {ShapeSpec{kBox, {0.1, 0.1, 0.1}}, {kSphere, {0.05}}, {kCylinder, {0.05, 0.1}}})
    scene.add(kind, {});
  CollisionStage stage(scene.model);
  const world::WorldState before = initial_state(scene.model);
  world::WorldState after = before;
  // Each body comes from above one of the plates, and goes through it.
  const auto shoot = [&](double z) {
    world::WorldState from = before;
    after = before;
    for (std::size_t i = 2; i < from.bodies.size(); ++i) {
      from.bodies[i].p_WC = {static_cast<double>(i) - 3.0, 0.0, z + 0.3};
      after.bodies[i].p_WC = {static_cast<double>(i) - 3.0, 0.0, z - 0.3};
    }
    return from;
  };
  for (const double z : {0.0, -1.0}) {
    const world::WorldState from = shoot(z);
    stage.hold_back(from, after);
    for (std::size_t i = 2; i < after.bodies.size(); ++i) EXPECT_GT(after.bodies[i].p_WC.z(), z) << i;
    const world::WorldState again = shoot(z);
    const test_support::AllocationScope scope;
    stage.hold_back(again, after);
    EXPECT_EQ(scope.counts().ours, 0u) << scope.describe_ours();
  }
}

}  // namespace
}  // namespace visum::collision::testing
