// Compares passages with closed forms of each solid, and with the solid's own definition along the line.
#include "server/sensing/solid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace visum::sensing {
namespace {

using Eigen::Vector3d;
using world::ShapeKind;

Solid solid_of(ShapeKind kind, std::array<double, 3> size) {
  world::WorldModel model;
  world::Shape shape;
  shape.kind = kind;
  shape.size = size;
  if (kind == ShapeKind::kConvex) {
    shape.mesh = {0};
    model.meshes.push_back({"tetrahedron", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}});
  }
  return make_solid(model, shape);
}

TEST(Solid, ALineThroughABallsCentreSeesItsDiameter) {
  const auto ball = solid_of(ShapeKind::kSphere, {0.5});
  const Vector3d d = Vector3d(1, 2, 3).normalized();
  const Passage p = pass_through(ball, -4 * d, d);
  EXPECT_NEAR(p.in, 3.5, 1e-14);
  EXPECT_NEAR(p.out, 4.5, 1e-14);
  EXPECT_NEAR((p.normal_in + d).norm(), 0.0, 1e-14);
}

TEST(Solid, AChordOfABallKeepsItsDigitsFarAway) {
  const auto ball = solid_of(ShapeKind::kSphere, {0.5});
  const Passage p = pass_through(ball, Vector3d(-1e5, 0.3, 0), Vector3d::UnitX());
  EXPECT_NEAR(p.in, 1e5 - 0.4, 1e-10);
  EXPECT_GT(pass_through(ball, Vector3d(-1e5, 0.5000001, 0), Vector3d::UnitX()).in, 1e300) << "misses";
}

TEST(Solid, ACylinderHasAMantleAndTwoLids) {
  const auto bar = solid_of(ShapeKind::kCylinder, {0.5, 2.0});
  EXPECT_NEAR(pass_through(bar, Vector3d(-3, 0.3, 0), Vector3d::UnitX()).in, 3 - 0.4, 1e-14);
  const Passage along = pass_through(bar, Vector3d(0.3, 0, -3), Vector3d::UnitZ());
  EXPECT_NEAR(along.in, 2.0, 1e-14);
  EXPECT_NEAR(along.out, 4.0, 1e-14);
  EXPECT_EQ(along.normal_in, -Vector3d::UnitZ());
  const Passage beside = pass_through(bar, Vector3d(0.6, 0, -3), Vector3d::UnitZ());
  EXPECT_GT(beside.in, beside.out);
}

TEST(Solid, APlaneIsSolidBelow) {
  const auto plane = solid_of(ShapeKind::kPlane, {});
  const Vector3d down = Vector3d(3, 0, -4) / 5;
  const Passage p = pass_through(plane, Vector3d(0, 0, 2), down);
  EXPECT_NEAR(p.in, 2.5, 1e-14);
  EXPECT_TRUE(std::isinf(p.out));
  const Passage away = pass_through(plane, Vector3d(0, 0, 2), -down);
  EXPECT_LT(away.out, 0.0);
}

struct Case {
  const char* name;
  ShapeKind kind;
  std::array<double, 3> size;
  bool (*inside)(const Vector3d&);
};

const Case kCases[] = {
    {"box",
     ShapeKind::kBox,
     {1.0, 2.0, 0.5},
     [](const Vector3d& x) {
       return std::abs(x[0]) <= 0.5 && std::abs(x[1]) <= 1.0 && std::abs(x[2]) <= 0.25;
     }},
    {"sphere", ShapeKind::kSphere, {0.8}, [](const Vector3d& x) { return x.norm() <= 0.8; }},
    {"cylinder",
     ShapeKind::kCylinder,
     {0.5, 1.2},
     [](const Vector3d& x) { return x.head<2>().norm() <= 0.5 && std::abs(x[2]) <= 0.6; }},
    {"capsule",
     ShapeKind::kCapsule,
     {0.3, 1.0},
     [](const Vector3d& x) { return (x - Vector3d(0, 0, std::clamp(x[2], -0.5, 0.5))).norm() <= 0.3; }},
    {"tetrahedron",
     ShapeKind::kConvex,
     {},
     [](const Vector3d& x) { return x.minCoeff() >= 0 && x.sum() <= 1; }},
};

class EverySolid : public testing::TestWithParam<Case> {};

// Along random lines: just inside of both ends is inside, just outside is not, and a miss meets nothing.
TEST_P(EverySolid, IsEnteredAndLeftWhereItsDefinitionSays) {
  const Case& solid_case = GetParam();
  const Solid solid = solid_of(solid_case.kind, solid_case.size);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  const auto random = [&] { return Vector3d(place(generator), place(generator), place(generator)); };
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = random(), d = random().normalized();
    const Passage passage = pass_through(solid, p, d);
    const auto inside = [&](double t) { return solid_case.inside(p + t * d); };
    if (passage.in > passage.out) {
      for (double t = -4; t < 4; t += 0.05) ASSERT_FALSE(inside(t)) << "a miss that hits";
      continue;
    }
    ++hits;
    if (passage.out - passage.in < 1e-6) continue;
    constexpr double kBit = 1e-9;
    ASSERT_FALSE(inside(passage.in - kBit)) << "enters late";
    ASSERT_TRUE(inside(passage.in + kBit)) << "enters early";
    ASSERT_TRUE(inside(passage.out - kBit)) << "leaves late";
    ASSERT_FALSE(inside(passage.out + kBit)) << "leaves early";
    ASSERT_NEAR(passage.normal_in.norm(), 1.0, 1e-12);
    ASSERT_LT(passage.normal_in.dot(d), 1e-9);
    ASSERT_GT(passage.normal_out.dot(d), -1e-9);
    for (int axis = 0; axis < 3; ++axis)
      for (const double t : {passage.in, passage.out}) {
        ASSERT_GE((p + t * d)[axis], solid.low[axis] - 1e-12);
        ASSERT_LE((p + t * d)[axis], solid.high[axis] + 1e-12);
      }
  }
  EXPECT_GT(hits, 200);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySolid, testing::ValuesIn(kCases),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace visum::sensing
