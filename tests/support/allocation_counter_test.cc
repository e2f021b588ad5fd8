#include "tests/support/allocation_counter.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision.h>
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

namespace visum::test_support {

// Outside the unnamed namespace, so that the program exports it.
__attribute__((noinline)) void allocate_by_a_name() {
  const auto value = std::make_unique<int>(1);
  asm volatile("" : : "g"(value.get()) : "memory");
}

namespace {

// Keeps the compiler from removing a pair of new and delete.
void use(const void* memory) {
  asm volatile("" : : "g"(memory) : "memory");
}

template <typename Work>
AllocationCounts count(Work work) {
  AllocationScope scope;
  work();
  return scope.counts();
}

TEST(AllocationScope, CountsNothingWhereNothingIsAllocated) {
  double sum = 0;
  const auto counts = count([&] {
    for (int i = 0; i < 100; ++i) sum += i;
  });
  EXPECT_EQ(sum, 4950);
  EXPECT_EQ(counts.ours, 0u);
  EXPECT_EQ(counts.foreign, 0u);
}

TEST(AllocationScope, CountsNewMallocAndRealloc) {
  const auto counts = count([] {
    use(std::make_unique<double>(1.0).get());
    void* memory = std::realloc(std::malloc(10), 1000);
    use(memory);
    std::free(memory);
    memory = std::calloc(3, 5);
    use(memory);
    std::free(memory);
  });
  EXPECT_EQ(counts.ours, 4u);
  EXPECT_EQ(counts.ours_bytes, sizeof(double) + 10 + 1000 + 15);
}

TEST(AllocationScope, CountsAlignedNew) {
  struct alignas(64) Wide {
    char bytes[64];
  };
  EXPECT_EQ(count([] { use(std::make_unique<Wide>().get()); }).ours, 1u);
}

TEST(AllocationScope, CountsAContainerThatGrows) {
  std::vector<int> grows, reserved;
  reserved.reserve(100);
  const auto counts = count([&] {
    for (int i = 0; i < 100; ++i) reserved.push_back(i);
    grows.push_back(1);
  });
  EXPECT_EQ(counts.ours, 1u);
}

TEST(AllocationScope, EndsWithItsBlockAndStartsAtZero) {
  { AllocationScope scope; }
  std::vector<int> outside(10);
  use(outside.data());
  EXPECT_EQ(count([] {}).ours, 0u);
}

TEST(AllocationScope, LeavesOtherThreadsAlone) {
  std::uint64_t elsewhere = 1;
  AllocationScope scope;
  const auto before = scope.counts().ours;
  std::thread other([&] { elsewhere = count([] { use(std::make_unique<int>(1).get()); }).ours; });
  const auto after_start = scope.counts().ours;  // starting a thread allocates here
  other.join();
  EXPECT_EQ(elsewhere, 1u);
  EXPECT_GT(after_start, before);
  EXPECT_EQ(scope.counts().ours, after_start);
}

TEST(AllocationScope, NamesWhereOursHappened) {
  AllocationScope scope;
  allocate_by_a_name();
  EXPECT_NE(scope.describe_ours().find("allocate_by_a_name"), std::string::npos) << scope.describe_ours();
}

class TwoBoxes {
 public:
  TwoBoxes() {
    a.setTranslation(fcl::Vector3d(0.5, 0, 0));
    a.computeAABB();
  }
  std::shared_ptr<fcl::Boxd> box = std::make_shared<fcl::Boxd>(1, 1, 1);
  fcl::CollisionObjectd a{box}, b{box};
};

TEST(AllocationOwner, IsFclWhereFclCollides) {
  TwoBoxes boxes;
  fcl::CollisionRequestd request(8, true);
  fcl::CollisionResultd result;
  const auto counts = count([&] { fcl::collide(&boxes.a, &boxes.b, request, result); });
  EXPECT_TRUE(result.isCollision());
  EXPECT_GT(counts.foreign, 0u);
  EXPECT_EQ(counts.ours, 0u);
}

bool callback_that_allocates(fcl::CollisionObjectd*, fcl::CollisionObjectd*, void* pairs) {
  static_cast<std::vector<int>*>(pairs)->push_back(1);
  return false;
}

TEST(AllocationOwner, IsUsWhereFclCallsUsAndWeAllocate) {
  TwoBoxes boxes;
  fcl::DynamicAABBTreeCollisionManagerd manager;
  manager.registerObject(&boxes.a);
  manager.registerObject(&boxes.b);
  manager.setup();
  std::vector<int> pairs;
  const auto counts = count([&] { manager.collide(&pairs, callback_that_allocates); });
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(counts.ours, 1u);
}

TEST(AllocationOwner, IsOdeWhereOdeSteps) {
  dInitODE();
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  const dJointID joint = dJointCreateHinge(world, nullptr);
  dJointAttach(joint, body, nullptr);
  const auto counts = count([&] { dWorldStep(world, 0.001); });
  dWorldDestroy(world);
  dCloseODE();
  EXPECT_GT(counts.foreign, 0u);
  EXPECT_EQ(counts.ours, 0u);
}

}  // namespace
}  // namespace visum::test_support
