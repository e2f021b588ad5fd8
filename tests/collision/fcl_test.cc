// Our stage against FCL's, over random pairs of convex solids: touch or not, depth, normal.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;

struct Kind {
  const char* name;
  ShapeSpec spec;
};
const std::vector<Kind> kKinds{{"Sphere", {kSphere, {0.3}}},
                               {"Box", {kBox, {0.6, 0.4, 0.5}}},
                               {"Capsule", {kCapsule, {0.2, 0.5}}},
                               {"Cylinder", {kCylinder, {0.25, 0.6}}},
                               {"Convex", {kConvex, {0.5, 0.6, 0.4}}}};

// Shapes that overlap or are apart by less than this (m) may touch for the one and not for the other.
constexpr double kTouchM = 1e-4;
constexpr double kShallowM = 2e-3;
constexpr int kPairs = 400;

double greatest_depth(const std::vector<Contact>& contacts) {
  double depth = 0.0;
  for (const Contact& contact : contacts) depth = std::max(depth, contact.depth);
  return depth;
}

struct Compared {
  int touching = 0, differ = 0;  // differ: one touches by more than kTouchM, the other does not
  int deeper = 0, turned = 0;    // FCL's depth is above ours by 1 mm; normals are 0.1 apart
};

Compared compare(const Kind& first, const Kind& second, bool shallow) {
  std::mt19937 generator{7};
  const auto next = [&] { return 2.0 * static_cast<double>(generator()) / 4294967295.0 - 1.0; };
  const auto pose = [&](double reach) {
    const double x = reach * next(), y = reach * next(), z = reach * next(), angle = 3.0 * next();
    const double ax = next(), ay = next(), az = next();
    return at(x, y, z, angle, Eigen::Vector3d(ax, ay, az).normalized());
  };
  Compared result;
  for (int i = 0; i < kPairs; ++i) {
    SceneBuilder scene;
    scene.add(first.spec, pose(0.05));
    scene.add(second.spec, pose(0.5));
    std::vector<Contact> ours = contacts_of(scene.model);
    // Bodies in motion overlap by little: the first shape is pushed out until 2 mm are left.
    if (shallow && !ours.empty()) {
      scene.model.bodies[0].X_WB.p += (greatest_depth(ours) - kShallowM) * ours[0].normal_W;
      ours = contacts_of(scene.model);
    }
    scene.model.collision_stage = world::CollisionKind::kFcl;
    const std::vector<Contact> theirs = contacts_of(scene.model);
    if (ours.empty() != theirs.empty()) {
      result.differ += std::max(greatest_depth(ours), greatest_depth(theirs)) > kTouchM;
      continue;
    }
    if (ours.empty()) continue;
    ++result.touching;
    const double more = greatest_depth(theirs) - greatest_depth(ours);
    result.deeper += more > 1e-3;
    result.turned += (ours[0].normal_W - theirs[0].normal_W).norm() > 0.1;
  }
  return result;
}

template <typename Check>
void for_all_kinds(bool shallow, Check check) {
  for (std::size_t i = 0; i < kKinds.size(); ++i)
    for (std::size_t j = i; j < kKinds.size(); ++j) {
      SCOPED_TRACE(std::string(kKinds[i].name) + " and " + kKinds[j].name);
      check(kKinds[i].spec.kind, kKinds[j].spec.kind, compare(kKinds[i], kKinds[j], shallow));
    }
}

TEST(Fcl, RandomPairsTouchForBothStagesOrForNeither) {
  for_all_kinds(false, [](ShapeKind, ShapeKind, const Compared& seen) {
    EXPECT_GT(seen.touching, 200);
    EXPECT_LT(seen.touching, kPairs);
    EXPECT_EQ(seen.differ, 0);
  });
}

// FCL tests these pairs without EPA.
bool is_exact(ShapeKind a, ShapeKind b) {
  return (a == kSphere && b != kConvex) || (a == kBox && b == kBox);
}

// FCL's EPA finds another direction in some pairs: of two capsules, for which a closed form is known, in 12
// of 294.
TEST(Fcl, DepthsAndNormalsOfShallowPairsAgree) {
  for_all_kinds(true, [](ShapeKind a, ShapeKind b, const Compared& seen) {
    EXPECT_GT(seen.touching, 200);
    const int most = is_exact(a, b) ? 0 : seen.touching / 10;
    EXPECT_LE(seen.deeper, most);
    EXPECT_LE(seen.turned, most);
    EXPECT_LE(seen.differ, is_exact(a, b) ? 0 : seen.touching / 100);
  });
}

TEST(Fcl, FindsTheSameContactsWhereverTheShapesHaveBeen) {
  SceneBuilder scene;
  scene.add({kPlane, {}}, {});
  for (int i = 0; i < 30; ++i)
    scene.add(kKinds[static_cast<std::size_t>(i) % kKinds.size()].spec,
              at(0.2 * (i % 6), 0.2 * (i / 6), 0.2));
  scene.model.collision_stage = world::CollisionKind::kFcl;
  const world::WorldState here = initial_state(scene.model);
  world::WorldState away = here;
  for (std::size_t i = 1; i < away.bodies.size(); ++i)
    away.bodies[i].p_WC *= 1.0 + 0.1 * static_cast<double>(i);
  CollisionStage moved(scene.model), fresh(scene.model);
  std::vector<Contact> first, again;
  moved.find(away, first);
  moved.find(here, first);
  fresh.find(here, again);
  ASSERT_GT(again.size(), 40u);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].shape_a, again[i].shape_a);
    EXPECT_EQ(first[i].p_W, again[i].p_W);
    EXPECT_EQ(first[i].normal_W, again[i].normal_W);
    EXPECT_EQ(first[i].depth, again[i].depth);
  }
}

}  // namespace
}  // namespace visum::collision::testing
