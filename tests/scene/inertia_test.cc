#include "server/scene/inertia.h"

#include <gtest/gtest.h>

#include <numbers>

#include "server/scene/mesh_readers.h"

namespace visum::scene {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;
using world::Shape;
using world::ShapeKind;

Shape shape(ShapeKind kind, std::array<double, 3> size) {
  Shape shape;
  shape.kind = kind;
  shape.size = size;
  return shape;
}

MassProperties solid(ShapeKind kind, std::array<double, 3> size) {
  return solid_of(shape(kind, size), nullptr);
}

MassProperties solid(const world::TriangleMesh& mesh) {
  return solid_of(shape(ShapeKind::kMesh, {}), &mesh);
}

// A box as 12 triangles, with one corner at `low`.
world::TriangleMesh box_mesh(const Vector3d& low, const Vector3d& lengths) {
  world::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(low + lengths.cwiseProduct(Vector3d(i & 1, (i >> 1) & 1, i >> 2)));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TEST(Inertia, BoxMatchesTheClosedForm) {
  const MassProperties box = solid(ShapeKind::kBox, {1, 2, 3});
  EXPECT_DOUBLE_EQ(box.mass_kg, 6);
  EXPECT_TRUE(box.inertia_C.isApprox(Eigen::Matrix3d(Vector3d(6.5, 5, 2.5).asDiagonal())));
}

TEST(Inertia, SphereMatchesTheClosedForm) {
  const MassProperties sphere = solid(ShapeKind::kSphere, {0.5, 0, 0});
  EXPECT_DOUBLE_EQ(sphere.mass_kg, pi / 6);
  EXPECT_DOUBLE_EQ(sphere.inertia_C(1, 1), 0.1 * pi / 6);
}

TEST(Inertia, CylinderMatchesTheClosedForm) {
  const MassProperties cylinder = solid(ShapeKind::kCylinder, {0.5, 2, 0});
  const double m = pi / 2;
  EXPECT_DOUBLE_EQ(cylinder.mass_kg, m);
  EXPECT_DOUBLE_EQ(cylinder.inertia_C(2, 2), m * 0.125);
  EXPECT_DOUBLE_EQ(cylinder.inertia_C(0, 0), m * (0.75 + 4) / 12);
}

// The same figure, summed from thin discs along z.
TEST(Inertia, CapsuleMatchesASumOfDiscs) {
  const double r = 0.3, half = 0.5;
  double mass = 0, along = 0, across = 0;
  const int steps = 200'000;
  const double reach = half + r, dz = 2 * reach / steps;
  for (int i = 0; i < steps; ++i) {
    const double z = -reach + (i + 0.5) * dz;
    const double beyond = std::max(0.0, std::abs(z) - half);
    const double r2 = r * r - beyond * beyond;
    const double m = pi * r2 * dz;
    mass += m;
    along += m * r2 / 2;
    across += m * (r2 / 4 + z * z);
  }
  const MassProperties capsule = solid(ShapeKind::kCapsule, {r, 2 * half, 0});
  EXPECT_NEAR(capsule.mass_kg, mass, 1e-9);
  EXPECT_NEAR(capsule.inertia_C(2, 2), along, 1e-9);
  EXPECT_NEAR(capsule.inertia_C(0, 0), across, 1e-9);
}

TEST(Inertia, AMeshOfABoxIsTheBoxWhereverItLies) {
  const MassProperties box = solid(ShapeKind::kBox, {1, 2, 3});
  const MassProperties mesh = solid(box_mesh({10, 20, -30}, {1, 2, 3}));
  EXPECT_NEAR(mesh.mass_kg, box.mass_kg, 1e-12);
  EXPECT_TRUE(mesh.com.isApprox(Vector3d(10.5, 21, -28.5)));
  EXPECT_TRUE(mesh.inertia_C.isApprox(box.inertia_C, 1e-9)) << mesh.inertia_C;
}

// The tetrahedron with corners at 0 and the three unit points has volume 1/6, centre 1/4, and integrals of x²
// = 1/60 and of xy = 1/120.
TEST(Inertia, TetrahedronMatchesTheClosedForm) {
  world::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const MassProperties solid_mesh = solid(mesh);
  const double m = 1.0 / 6, c = 0.25;
  EXPECT_NEAR(solid_mesh.mass_kg, m, 1e-15);
  EXPECT_NEAR(solid_mesh.com[0], c, 1e-15);
  EXPECT_NEAR(solid_mesh.inertia_C(0, 0), 2.0 / 60 - m * 2 * c * c, 1e-15);
  EXPECT_NEAR(solid_mesh.inertia_C(0, 1), -1.0 / 120 + m * c * c, 1e-15);
}

TEST(Inertia, FacesTurnedInwardsGiveTheSameSolid) {
  world::TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 2, 3});
  const MassProperties outside = solid(mesh);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(solid_fault(mesh), "");
  EXPECT_NEAR(solid(mesh).mass_kg, outside.mass_kg, 1e-12);
  EXPECT_TRUE(solid(mesh).inertia_C.isApprox(outside.inertia_C));
}

TEST(Inertia, OpenTwistedAndFlatMeshesBoundNoSolid) {
  world::TriangleMesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  EXPECT_EQ(solid_fault(mesh), "is not closed (an edge has no neighbour, or faces are turned inside out)");
  mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  EXPECT_EQ(solid_fault(mesh), "is not closed (an edge has no neighbour, or faces are turned inside out)");
  mesh.triangles = {{0, 1, 2}, {2, 1, 0}};
  EXPECT_EQ(solid_fault(mesh), "encloses no volume");
}

TEST(Inertia, TwoHalvesMakeTheWhole) {
  const MassProperties half = solid(ShapeKind::kBox, {1, 2, 1.5});
  const MassProperties upper = moved(half, {Vector3d(0, 0, 0.75), Eigen::Quaterniond::Identity()});
  const MassProperties lower = moved(half, {Vector3d(0, 0, -0.75), Eigen::Quaterniond::Identity()});
  const MassProperties whole = together(upper, lower);
  EXPECT_NEAR(whole.mass_kg, 6, 1e-12);
  EXPECT_TRUE(whole.com.isZero(1e-15));
  EXPECT_TRUE(whole.inertia_C.isApprox(solid(ShapeKind::kBox, {1, 2, 3}).inertia_C));
}

TEST(Inertia, TurningASolidTurnsItsInertia) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(pi / 2, Vector3d::UnitX()));
  const MassProperties turned = moved(solid(ShapeKind::kBox, {1, 2, 3}), {Vector3d(1, 0, 0), q});
  EXPECT_TRUE(turned.inertia_C.isApprox(Eigen::Matrix3d(Vector3d(6.5, 2.5, 5).asDiagonal())));
  EXPECT_TRUE(turned.com.isApprox(Vector3d(1, 0, 0)));
}

}  // namespace
}  // namespace visum::scene
