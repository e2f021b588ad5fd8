// Our stage against FCL's, over random pairs of convex solids: touch or not, depth, normal.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;
using Eigen::Vector3d;

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

// Random numbers in -1..1 and random poses; the same in every run.
class FclRandom {
 public:
  double next() { return 2.0 * static_cast<double>(generator_()) / 4294967295.0 - 1.0; }
  Pose pose(double reach) {
    const double x = reach * next(), y = reach * next(), z = reach * next(), angle = 3.0 * next();
    const double ax = next(), ay = next(), az = next();
    return at(x, y, z, angle, Vector3d(ax, ay, az).normalized());
  }
  Vector3d direction() {
    Vector3d along(0.0, 0.0, 0.0);
    while (along.norm() > 1.0 || along.norm() < 0.1)
      for (int i = 0; i < 3; ++i) along[i] = next();
    return along.normalized();
  }

 private:
  std::mt19937 generator_{7};
};

// The two shapes, the first pushed out along the normal until no more than `depth` is left, where they touch.
struct RandomPair {
  RandomPair(const Kind& first, const Kind& second, FclRandom& random, double depth) {
    scene.add(first.spec, random.pose(0.05));
    scene.add(second.spec, random.pose(0.5));
    contacts = contacts_of(scene.model);
    if (contacts.empty() || greatest_depth(contacts) <= depth) return;
    scene.model.bodies[0].X_WB.p += (greatest_depth(contacts) - depth) * contacts[0].normal_W;
    contacts = contacts_of(scene.model);
  }
  std::vector<Contact> contacts_by_fcl() {
    scene.model.collision_stage = world::CollisionKind::kFcl;
    return contacts_of(scene.model);
  }

  SceneBuilder scene;
  std::vector<Contact> contacts;  // of our stage
};

struct Compared {
  int touching = 0, differ = 0;  // differ: one touches by more than kTouchM, the other does not
  int deeper = 0, turned = 0;    // FCL's depth is above ours by 1 mm; normals are 0.1 apart
};

Compared compare(const Kind& first, const Kind& second, bool shallow) {
  FclRandom random;
  Compared result;
  for (int i = 0; i < kPairs; ++i) {
    // Bodies in motion overlap by little.
    RandomPair pair(first, second, random, shallow ? kShallowM : std::numeric_limits<double>::infinity());
    const std::vector<Contact>& ours = pair.contacts;
    const std::vector<Contact> theirs = pair.contacts_by_fcl();
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

// How far a shape reaches along a direction, from W's origin.
double reach_along(const ShapeSpec& spec, const Pose& X, const Vector3d& direction_W) {
  const Vector3d u = X.q.conjugate() * direction_W;
  const double middle = X.p.dot(direction_W), end = 0.5 * spec.size[1] * std::abs(u.z());
  if (spec.kind == kSphere) return middle + spec.size[0];
  if (spec.kind == kCapsule) return middle + spec.size[0] + end;
  if (spec.kind == kCylinder) return middle + spec.size[0] * u.head<2>().norm() + end;
  return middle + 0.5 * Vector3d::Map(spec.size.data()).dot(u.cwiseAbs());
}

// How far the first of two shapes must go along a direction to be free of the second, m.
class Overlap {
 public:
  Overlap(const Kind& first, const Kind& second, const world::WorldModel& model)
      : first_(first.spec), second_(second.spec), A_(model.bodies[0].X_WB), B_(model.bodies[1].X_WB) {}

  double along(const Vector3d& u) const { return reach_along(second_, B_, u) + reach_along(first_, A_, -u); }

  // The least along the faces and edges of boxes, along random directions, and along some near `normal`.
  double least(const Vector3d& normal, FclRandom& random) const {
    constexpr int kTries = 300;
    double least = std::numeric_limits<double>::infinity();
    const auto take = [&](const Vector3d& axis) {
      if (axis.norm() < 1e-3) return;
      for (const double sign : {1.0, -1.0}) least = std::min(least, along(sign * axis.normalized()));
    };
    for (int i = 0; i < 3; ++i) {
      take(A_.q * Vector3d::Unit(i));
      take(B_.q * Vector3d::Unit(i));
      for (int k = 0; k < 3; ++k) take((A_.q * Vector3d::Unit(i)).cross(B_.q * Vector3d::Unit(k)));
    }
    for (int i = 0; i < kTries; ++i) {
      take(random.direction());
      for (const double turn : {0.003, 0.05}) take(normal + turn * random.direction());
    }
    return least;
  }

 private:
  ShapeSpec first_, second_;
  Pose A_, B_;
};

bool is_flat(ShapeKind kind) {
  return kind == kBox || kind == kConvex;
}

// Our stage has its direction from EPA, too, where a cylinder's core and another one overlap that is not
// round.
bool has_direction_of_epa(ShapeKind a, ShapeKind b) {
  return (a == kCylinder && (b == kCylinder || is_flat(b))) || (b == kCylinder && is_flat(a));
}

struct Deep {
  int touching = 0;
  int longer = 0;  // another direction is shorter
  int held = 0;    // for FCL they still touch, once moved apart by our depth and 0.1 mm
  int let_go = 0;  // for FCL they are apart once moved by 0.1 mm less
};

Deep compare_deep(const Kind& first, const Kind& second, double depth) {
  const ShapeKind a = first.spec.kind, b = second.spec.kind;
  // A face is preferred to edges that are shorter by up to 5 %, so that contacts do not flicker.
  const double share = is_flat(a) && is_flat(b) ? 0.95 : 1.0;
  const double slack = has_direction_of_epa(a, b) ? kTouchM : 1e-6;
  FclRandom random;
  Deep result;
  for (int i = 0; i < kPairs; ++i) {
    RandomPair pair(first, second, random, depth);
    if (pair.contacts.empty()) continue;
    ++result.touching;
    const Vector3d normal = pair.contacts[0].normal_W;
    const Overlap overlap(first, second, pair.scene.model);
    result.longer += share * overlap.along(normal) > overlap.least(normal, random) + slack;
    Vector3d& place = pair.scene.model.bodies[0].X_WB.p;
    const Vector3d start = place;
    const double found = greatest_depth(pair.contacts);
    place = start + (found + kTouchM) * normal;
    result.held += !pair.contacts_by_fcl().empty();
    place = start + (share * found - kTouchM) * normal;
    result.let_go += pair.contacts_by_fcl().empty();
  }
  return result;
}

// How many of the pairs may be wrong.
struct Allowed {
  int longer = 0, held = 0, let_go = 0;
};

Allowed allowed(ShapeKind a, ShapeKind b, int touching) {
  // Up to 3 % are seen at 2 mm.
  if (has_direction_of_epa(a, b)) return {touching / 25, touching / 25, touching / 25};
  Allowed most;
  // Features that lie beside each other give one contact midway, which is not deep enough: 1.4 % are seen.
  if (a == kCapsule && b == kCylinder) most.held = touching / 50;
  // Some touching pairs FCL does not find: up to 2 of 365.
  if (a == kConvex || b == kConvex) most.let_go = touching / 100;
  return most;
}

void expect_apart_by_our_depth(const Kind& first, const Kind& second, double depth) {
  SCOPED_TRACE(std::string(first.name) + " and " + second.name + " at " + std::to_string(depth) + " m");
  const Deep seen = compare_deep(first, second, depth);
  const Allowed most = allowed(first.spec.kind, second.spec.kind, seen.touching);
  EXPECT_GT(seen.touching, 200);
  EXPECT_LE(seen.longer, most.longer) << "another direction is shorter";
  EXPECT_LE(seen.held, most.held) << "the depth is too small";
  EXPECT_LE(seen.let_go, most.let_go) << "the depth is too large";
}

// FCL's depths of deep pairs are not to be trusted, but FCL can say whether our depth along our normal takes
// the shapes apart, and no less does. No other direction is shorter. Directions of EPA are held to that at 2
// mm alone: at 3 cm a fifth of them is not the shortest.
TEST(Fcl, DeepPairsComeApartByOurDepthAndByNoLess) {
  constexpr double kDeepM = 0.03;  // the shapes are 0.4 to 0.9 m long
  for (std::size_t i = 0; i < kKinds.size(); ++i)
    for (std::size_t j = i; j < kKinds.size(); ++j) {
      expect_apart_by_our_depth(kKinds[i], kKinds[j], kShallowM);
      if (!has_direction_of_epa(kKinds[i].spec.kind, kKinds[j].spec.kind))
        expect_apart_by_our_depth(kKinds[i], kKinds[j], kDeepM);
    }
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
