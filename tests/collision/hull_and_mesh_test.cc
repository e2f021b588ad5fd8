#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "server/collision/hull.h"
#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;

double volume(const Polytope& hull) {
  double sum = 0.0;
  for (const Polytope::Face& face : hull.faces) {
    const auto corners = hull.corners_of(face);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
      sum +=
          hull.vertices[corners[0]].dot(hull.vertices[corners[i]].cross(hull.vertices[corners[i + 1]])) / 6.0;
  }
  return sum;
}

void expect_closed_and_convex(const Polytope& hull) {
  for (const Polytope::Face& face : hull.faces) {
    EXPECT_GE(face.count, 3u);
    const double offset = face.normal.dot(hull.vertices[hull.corners[face.first]]);
    for (const auto& vertex : hull.vertices) EXPECT_LT(face.normal.dot(vertex) - offset, 1e-5);
  }
  std::size_t edges = 0;
  for (const Polytope::Face& face : hull.faces) edges += face.count;
  EXPECT_EQ(hull.vertices.size() + hull.faces.size(), edges / 2 + 2) << "Euler's formula";
}

TEST(Hull, OfABoxHasSixFacesWhateverLiesInside) {
  std::vector<Eigen::Vector3d> points = box_mesh({2, 3, 4}).vertices;
  points.insert(points.begin(), {{0, 0, 0}, {0.5, 1, 1.5}, {1, 0, 0}, {1, 1.5, 0}});
  const Polytope hull = make_hull(points);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_EQ(hull.faces.size(), 6u);
  EXPECT_NEAR(volume(hull), 24.0, 1e-12);
  expect_closed_and_convex(hull);
}

TEST(Hull, OfRandomPointsIsClosedAndConvex) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 200; ++i) points.emplace_back(normal(random), normal(random), normal(random));
    const Polytope hull = make_hull(points);
    expect_closed_and_convex(hull);
    EXPECT_GT(volume(hull), 10.0);
  }
}

TEST(Hull, OfAFinePrismJoinsItsCapsToPolygons) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 24; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 24;
    for (const double z : {-0.5, 0.5}) points.emplace_back(std::cos(angle), std::sin(angle), z);
  }
  const Polytope hull = make_hull(points);
  EXPECT_EQ(hull.faces.size(), 26u);
  EXPECT_NEAR(volume(hull), 12.0 * std::sin(2.0 * std::numbers::pi / 24), 1e-9);
  expect_closed_and_convex(hull);
}

// Meshes in files have turned, rounded coordinates, so that no four points of a cap lie in one plane.
TEST(Hull, OfATurnedPrismOfRoundedCoordinatesIsThePrism) {
  for (const int sides : {30, 60, 100, 150}) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2 + 0.01 * sides).normalized();
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * (7 * i % sides) / sides;
      for (const double z : {-0.02, 0.02})
        points.push_back(
            (turn * Eigen::Vector3d(std::cos(angle), std::sin(angle), z)).cast<float>().cast<double>());
    }
    const Polytope hull = make_hull(points);
    EXPECT_LE(hull.faces.size(), 2 * points.size());
    const double size = 2.0;
    for (const Polytope::Face& face : hull.faces) {
      const double offset = face.normal.dot(hull.vertices[hull.corners[face.first]]);
      for (const auto& point : points) EXPECT_LT(face.normal.dot(point) - offset, 2e-5 * size) << sides;
    }
    EXPECT_NEAR(volume(hull), 0.02 * sides * std::sin(2.0 * std::numbers::pi / sides), 1e-4) << sides;
  }
}

TEST(Hull, PointsInAPlaneAreRefused) {
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_THROW(make_hull(points), std::runtime_error);
}

// A grid of triangles in the plane z = 0.
world::TriangleMesh floor_mesh(int cells, double size) {
  world::TriangleMesh mesh;
  mesh.name = "floor";
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j)
      mesh.vertices.emplace_back(size * (i - 0.5 * cells), size * (j - 0.5 * cells), 0);
  }
  const auto corner = [cells](int i, int j) { return static_cast<std::uint32_t>(i * (cells + 1) + j); };
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      mesh.triangles.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
      mesh.triangles.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
    }
  }
  return mesh;
}

class OnAFlatMesh : public ::testing::TestWithParam<ShapeSpec> {};

// Wherever a body lies, over corners and edges of the grid, nothing pushes it sideways.
TEST_P(OnAFlatMesh, NothingPushesSideways) {
  for (int i = 0; i < 60; ++i) {
    SceneBuilder scene;
    const double depth = 1e-4 * (1 + i % 7);
    scene.add_fixed({kMesh, {1, 1, 1}}, {});
    scene.model.meshes[0] = floor_mesh(20, 0.1);
    scene.add(GetParam(), at(0.013 * i - 0.3, 0.007 * i - 0.2, 0.1 - depth, 0.11 * i, {0, 0, 1}));
    const auto contacts = contacts_of(scene.model);
    ASSERT_FALSE(contacts.empty());
    double deepest = 0.0;
    for (const Contact& contact : contacts) {
      EXPECT_NEAR(std::abs(contact.normal_W.z()), 1.0, 1e-6);
      deepest = std::max(deepest, contact.depth);
    }
    EXPECT_NEAR(deepest, depth, 1e-6);
  }
}

TEST_P(OnAFlatMesh, TheContactsSurroundItsMiddle) {
  if (GetParam().kind == kSphere) GTEST_SKIP() << "a ball has one point";
  SceneBuilder scene;
  scene.add_fixed({kMesh, {1, 1, 1}}, {});
  scene.model.meshes[0] = floor_mesh(20, 0.1);
  scene.add(GetParam(), at(0.03, 0.04, 0.0999, 0.4, {0, 0, 1}));
  Eigen::AlignedBox3d box;
  for (const Contact& contact : contacts_of(scene.model)) box.extend(contact.p_W);
  EXPECT_LT(box.min().x(), 0.03 - 0.05);
  EXPECT_GT(box.max().x(), 0.03 + 0.05);
  EXPECT_LT(box.min().y(), 0.04 - 0.05);
  EXPECT_GT(box.max().y(), 0.04 + 0.05);
}

INSTANTIATE_TEST_SUITE_P(Shapes, OnAFlatMesh,
                         ::testing::Values(ShapeSpec{kBox, {0.3, 0.3, 0.2}}, ShapeSpec{kSphere, {0.1}},
                                           ShapeSpec{kCylinder, {0.15, 0.2}},
                                           ShapeSpec{kConvex, {0.3, 0.3, 0.2}}));

TEST(Mesh, ABallBesideItsSharpEdgeIsPushedAwayFromTheEdge) {
  SceneBuilder scene;
  scene.add_fixed({kMesh, {1, 1, 1}}, {});
  const Eigen::Vector3d out(0.06, 0, 0.08);  // from the edge at x = z = 0.5
  scene.add({kSphere, {0.11}}, at(0.5 + out.x(), 0.1, 0.5 + out.z()));
  const auto contacts = contacts_of(scene.model);
  ASSERT_FALSE(contacts.empty());
  for (const Contact& contact : contacts) {
    EXPECT_LT((contact.normal_W + out.normalized()).norm(), 1e-6);
    EXPECT_NEAR(contact.depth, 0.01, 1e-6);
  }
}

TEST(Mesh, TrianglesWithoutAreaAreLeftOut) {
  SceneBuilder scene;
  scene.add_fixed({kMesh, {1, 1, 1}}, {});
  scene.model.meshes[0].triangles.push_back({0, 0, 1});
  scene.model.meshes[0].triangles.push_back({3, 3, 3});
  scene.add({kBox, {0.2, 0.2, 0.2}}, at(0, 0, 0.599));
  for (const Contact& contact : contacts_of(scene.model)) EXPECT_NEAR(contact.normal_W.z(), -1.0, 1e-9);
}

}  // namespace
}  // namespace visum::collision::testing
