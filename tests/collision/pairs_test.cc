// Every pair of kinds of shape, in an arrangement whose contact has a closed form: depth, normal, count.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;
constexpr double kPi = std::numbers::pi;
const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(),
                      kZ = Eigen::Vector3d::UnitZ();

const ShapeSpec kUnitBox{kBox, {1, 1, 1}};
const ShapeSpec kBall{kSphere, {0.5}};
const ShapeSpec kCan{kCylinder, {0.5, 1.0}};
const ShapeSpec kSlimCan{kCylinder, {0.4, 1.0}};
const ShapeSpec kPill{kCapsule, {0.25, 1.0}};
const ShapeSpec kGround{kPlane, {}};
const ShapeSpec kHull{kConvex, {1, 1, 1}};
const ShapeSpec kBoxMesh{kMesh, {1, 1, 1}};

struct Case {
  const char* name;
  ShapeSpec a;
  Pose X_WA;
  ShapeSpec b;
  Pose X_WB;
  double depth;
  Eigen::Vector3d normal;  // from b to a
  std::size_t least_points;
  std::size_t most_points;

  friend void PrintTo(const Case& test, std::ostream* out) { *out << test.name; }
};

// a stands upon b and overlaps by 1 mm. b's top is at 0.5, or at 0 for the plane.
constexpr double kDepth = 1e-3;
const Pose kOnTop = at(0.02, 0.01, 1.0 - kDepth);
const Pose kTilted = at(0.02, 0.01, 1.0 - kDepth, kPi / 2, kX);

const std::vector<Case> kCases{
    {"SphereOnSphere", kBall, at(0, 0, 1 - kDepth), kBall, at(0, 0, 0), kDepth, kZ, 1, 1},
    {"SphereBesideSphere",
     kBall,
     at(0.6 * 0.999, 0.8 * 0.999, 0),
     kBall,
     at(0, 0, 0),
     1e-3,
     {0.6, 0.8, 0},
     1,
     1},
    {"SphereOnBox", kBall, kOnTop, kUnitBox, {}, kDepth, kZ, 1, 1},
    {"SphereOnBoxEdge",
     kBall,
     at(0.5 + 0.3, 0, 0.5 + 0.4 - kDepth * 0.8),
     kUnitBox,
     {},
     0.5 - std::hypot(0.3, 0.4 - kDepth * 0.8),
     Eigen::Vector3d(0.3, 0, 0.4 - kDepth * 0.8).normalized(),
     1,
     1},
    {"SphereDeepInBox", kBall, at(0, 0, 0.3), kUnitBox, {}, 0.7, kZ, 1, 1},
    {"SphereOnCylinder", kBall, kOnTop, kCan, {}, kDepth, kZ, 1, 1},
    {"SphereBesideCylinder", kBall, at(1 - kDepth, 0, 0.1), kCan, {}, kDepth, kX, 1, 1},
    {"SphereOnCapsule", kBall, at(0, 0, 1.25 - kDepth), kPill, {}, kDepth, kZ, 1, 1},
    {"SphereBesideCapsule", kBall, at(0.75 - kDepth, 0, 0.2), kPill, {}, kDepth, kX, 1, 1},
    {"SphereOnPlane", kBall, at(3, 4, 0.5 - kDepth), kGround, {}, kDepth, kZ, 1, 1},
    {"SphereOnHull", kBall, kOnTop, kHull, {}, kDepth, kZ, 1, 1},
    {"SphereOnMesh", kBall, kOnTop, kBoxMesh, {}, kDepth, kZ, 1, 1},
    {"BoxOnBox", kUnitBox, kOnTop, kUnitBox, {}, kDepth, kZ, 4, 4},
    {"TurnedBoxOnBox", kUnitBox, at(0, 0, 1 - kDepth, kPi / 4, kZ), kUnitBox, {}, kDepth, kZ, 8, 8},
    {"BoxOnEdgeOnBox",
     kUnitBox,
     at(0, 0, 0.5 + std::sqrt(0.5) - kDepth, kPi / 4, kX),
     kUnitBox,
     {},
     kDepth,
     kZ,
     2,
     2},
    {"BoxEdgesCross", kUnitBox, at(0, 0, std::sqrt(2.0) - kDepth, kPi / 4, kX), kUnitBox,
     at(0, 0, 0, kPi / 4, kY), kDepth, kZ, 1, 1},
    {"BoxOnPlane", kUnitBox, at(3, 4, 0.5 - kDepth), kGround, {}, kDepth, kZ, 4, 4},
    {"BoxOnCylinder", kUnitBox, kOnTop, kCan, {}, kDepth, kZ, 4, 8},
    {"BoxOnLyingCylinder", kUnitBox, kOnTop, kCan, at(0, 0, 0, kPi / 2, kX), kDepth, kZ, 2, 2},
    {"BoxOnCapsule", kUnitBox, at(0.1, 0, 0.75 - kDepth), kPill, at(0, 0, 0, kPi / 2, kX), kDepth, kZ, 2, 2},
    {"BoxOnHull", kUnitBox, kOnTop, kHull, {}, kDepth, kZ, 4, 4},
    {"BoxOnMesh", kUnitBox, kOnTop, kBoxMesh, {}, kDepth, kZ, 4, 8},
    {"CylinderOnPlane", kCan, at(0, 0, 0.5 - kDepth), kGround, {}, kDepth, kZ, 8, 8},
    {"LyingCylinderOnPlane", kCan, at(0, 0, 0.5 - kDepth, kPi / 2, kX), kGround, {}, kDepth, kZ, 2, 2},
    {"CylinderOnBox", kCan, at(0, 0, 1 - kDepth), kUnitBox, {}, kDepth, kZ, 8, 8},
    {"LyingCylinderOnBox", kCan, at(0, 0, 1 - kDepth, kPi / 2, kX), kUnitBox, {}, kDepth, kZ, 2, 2},
    {"CylinderOnCylinder", kCan, kOnTop, kCan, {}, kDepth, kZ, 4, 8},
    {"CylindersSideBySide", kCan, at(1 - kDepth, 0, 0.1), kCan, {}, kDepth, kX, 2, 2},
    {"CylindersCross", kCan, at(0, 0, 1 - kDepth, kPi / 2, kX), kCan, at(0, 0, 0, kPi / 2, kY), kDepth, kZ, 1,
     1},
    {"CylinderOnCapsule", kCan, at(0, 0, 0.75 - kDepth), kPill, at(0, 0, 0, kPi / 2, kX), kDepth, kZ, 2, 2},
    {"CylinderOnHull", kCan, at(0, 0, 1 - kDepth), kHull, {}, kDepth, kZ, 8, 8},
    {"CylinderOnMesh", kSlimCan, at(0, 0, 1 - kDepth), kBoxMesh, {}, kDepth, kZ, 4, 8},
    {"CapsuleOnPlane", kPill, at(0, 0, 0.25 - kDepth, kPi / 2, kX), kGround, {}, kDepth, kZ, 2, 2},
    {"StandingCapsuleOnPlane", kPill, at(0, 0, 0.75 - kDepth), kGround, {}, kDepth, kZ, 1, 1},
    {"CapsuleOnCapsule", kPill, at(0, 0, 0.5 - kDepth, kPi / 2, kX), kPill, at(0, 0, 0, kPi / 2, kX), kDepth,
     kZ, 2, 2},
    {"CapsulesCross", kPill, at(0, 0, 0.5 - kDepth, kPi / 2, kX), kPill, at(0, 0, 0, kPi / 2, kY), kDepth, kZ,
     1, 1},
    {"CapsuleOnHull", kPill, at(0.1, 0, 0.75 - kDepth, kPi / 2, kX), kHull, {}, kDepth, kZ, 2, 2},
    {"CapsuleOnMesh", kPill, at(0.1, 0, 0.75 - kDepth, kPi / 2, kX), kBoxMesh, {}, kDepth, kZ, 2, 4},
    {"HullOnPlane", kHull, at(0, 0, 0.5 - kDepth), kGround, {}, kDepth, kZ, 4, 4},
    {"HullOnHull", kHull, kOnTop, kHull, {}, kDepth, kZ, 4, 4},
    {"HullOnMesh", kHull, kOnTop, kBoxMesh, {}, kDepth, kZ, 4, 8},
    {"MeshOnPlane", kBoxMesh, at(0, 0, 0.5 - kDepth), kGround, {}, kDepth, kZ, 4, 4},
    {"MeshOnMesh", kBoxMesh, kOnTop, kBoxMesh, {}, kDepth, kZ, 4, 8},
};

class Pairs : public ::testing::TestWithParam<Case> {};

void expect_contacts(const std::vector<Contact>& contacts, const Case& test, double sign) {
  EXPECT_GE(contacts.size(), test.least_points);
  EXPECT_LE(contacts.size(), test.most_points);
  double deepest = 0.0;
  for (const Contact& contact : contacts) {
    EXPECT_GT(contact.depth, 0.0);
    EXPECT_NEAR(contact.normal_W.norm(), 1.0, 1e-12);
    EXPECT_LT((contact.normal_W - sign * test.normal).norm(), 1e-6)
        << "normal " << contact.normal_W.transpose() << " at " << contact.p_W.transpose();
    deepest = std::max(deepest, contact.depth);
  }
  EXPECT_NEAR(deepest, test.depth, 1e-6);
}

TEST_P(Pairs, DepthNormalAndCountAreAsInClosedForm) {
  const Case& test = GetParam();
  expect_contacts(contacts_between(test.a, test.X_WA, test.b, test.X_WB), test, 1.0);
}

TEST_P(Pairs, TheNormalTurnsWithTheOrderOfTheShapes) {
  const Case& test = GetParam();
  expect_contacts(contacts_between(test.b, test.X_WB, test.a, test.X_WA), test, -1.0);
}

TEST_P(Pairs, ContactsDoNotDependOnWhereInTheWorldThePairStands) {
  const Case& test = GetParam();
  const Pose moved = at(1.3, -2.1, 0.7, 1.1, {1, 2, 3});
  Case turned = test;
  turned.normal = moved.q * test.normal;
  expect_contacts(contacts_between(test.a, moved * test.X_WA, test.b, moved * test.X_WB), turned, 1.0);
}

TEST_P(Pairs, ShapesApartDoNotTouch) {
  const Case& test = GetParam();
  Pose away = test.X_WA;
  away.p += (test.depth + 1e-5) * test.normal;
  EXPECT_TRUE(contacts_between(test.a, away, test.b, test.X_WB).empty());
}

TEST_P(Pairs, PointsLieMidwayBetweenTheSurfaces) {
  // Pushing a out by half the depth moves each point by a quarter of the depth along the normal, not by more
  // than a half.
  const Case& test = GetParam();
  if (test.depth > 0.1) GTEST_SKIP() << "the nearest face is another one by then";
  const auto before = contacts_between(test.a, test.X_WA, test.b, test.X_WB);
  Pose out = test.X_WA;
  out.p += 0.5 * test.depth * test.normal;
  const auto after = contacts_between(test.a, out, test.b, test.X_WB);
  ASSERT_FALSE(before.empty());
  ASSERT_FALSE(after.empty());
  double height_before = -1e9, height_after = -1e9;
  for (const Contact& c : before) height_before = std::max(height_before, c.p_W.dot(test.normal));
  for (const Contact& c : after) height_after = std::max(height_after, c.p_W.dot(test.normal));
  EXPECT_NEAR(height_after - height_before, 0.25 * test.depth, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(AllKinds, Pairs, ::testing::ValuesIn(kCases),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace visum::collision::testing
