// Balls on the ridges, tips and corners of meshes. There the nearest point lies on no face, whichever way the
// surface bends and however its faces are cut into triangles.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <cmath>
#include <numbers>
#include <random>

#include "server/collision/mesh.h"
#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;
constexpr double kBallM = 0.05;
constexpr double kSunkM = 1e-5;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

// The ball's middle is in direction `out` (unit) from `tip`, which is the mesh's nearest point.
void expect_pushed_out(const world::TriangleMesh& mesh, const Eigen::Vector3d& tip,
                       const Eigen::Vector3d& out) {
  SceneBuilder scene;
  const Eigen::Vector3d middle = tip + (kBallM - kSunkM) * out;
  scene.add({kSphere, {kBallM}}, at(middle.x(), middle.y(), middle.z()));
  scene.add_fixed({kMesh, {1, 1, 1}}, {});
  scene.model.meshes[0] = mesh;
  const auto contacts = contacts_of(scene.model);
  ASSERT_FALSE(contacts.empty()) << "at " << tip.transpose() << " towards " << out.transpose();
  double deepest = 0.0;
  for (const Contact& contact : contacts) {
    EXPECT_LT((contact.normal_W - out).norm(), 2e-3) << "at " << tip.transpose();
    deepest = std::max(deepest, contact.depth);
  }
  EXPECT_NEAR(deepest, kSunkM, 1e-7) << "at " << tip.transpose();
}

class MeshRidge : public ::testing::TestWithParam<double> {};

// A roof of two long and narrow faces, as the side of a fine prism.
TEST_P(MeshRidge, CarriesABallAllAlong) {
  const double slope = radians(GetParam());
  const double x = 0.01 * std::cos(slope), z = -0.01 * std::sin(slope);
  world::TriangleMesh roof;
  roof.name = "roof";
  for (const double y : {-0.25, 0.25}) {
    roof.vertices.emplace_back(-x, y, z);
    roof.vertices.emplace_back(0, y, 0);
    roof.vertices.emplace_back(x, y, z);
  }
  roof.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  for (int i = -4; i <= 4; ++i) {
    const double lean = 0.24 * i * slope;
    for (double y = -0.23; y < 0.24; y += 0.02)
      expect_pushed_out(roof, {0, y, 0}, {std::sin(lean), 0, std::cos(lean)});
  }
}

INSTANTIATE_TEST_SUITE_P(Slopes, MeshRidge, ::testing::Values(0.02, 0.1, 0.3, 0.5, 0.6, 1.0, 5.0, 30.0));

// Each of its edges is nearly flat; all together make a tip.
TEST(MeshTip, OfAFlatConeCarriesABall) {
  for (const double slope : {radians(0.5), radians(2.0), radians(20.0)}) {
    constexpr std::uint32_t kSides = 48;
    world::TriangleMesh cone;
    cone.name = "cone";
    cone.vertices.emplace_back(0, 0, 0);
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSides;
      cone.vertices.emplace_back(std::cos(angle), std::sin(angle), -std::tan(slope));
      cone.triangles.push_back({0, i + 1, (i + 1) % kSides + 1});
    }
    for (int i = 0; i < 7; ++i) {
      const double lean = 0.9 * slope * i / 7, way = 0.83 * i;
      expect_pushed_out(cone, {0, 0, 0},
                        {std::sin(lean) * std::cos(way), std::sin(lean) * std::sin(way), std::cos(lean)});
    }
  }
}

TEST(MeshCorner, OfABoxCarriesABall) {
  const auto box = box_mesh({0.2, 0.2, 0.2});
  for (const Eigen::Vector3d& corner : box.vertices) {
    for (const Eigen::Vector3d& aside :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, -0.2, 0.3)})
      expect_pushed_out(box, corner, (corner.normalized() + aside).normalized());
  }
}

// A ball that rolls over edges between flat triangles does not stumble.
TEST(MeshCorner, BetweenFlatTrianglesPushesNobodyAside) {
  world::TriangleMesh floor;
  floor.name = "fan";
  floor.vertices.emplace_back(0, 0, 0);
  for (int i = 0; i < 7; ++i) floor.vertices.emplace_back(std::cos(0.9 * i), std::sin(0.9 * i), 0);
  for (std::uint32_t i = 1; i <= 7; ++i) floor.triangles.push_back({0, i, i % 7 + 1});
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d under(2e-4 * i * std::cos(0.7 * i), 2e-4 * i * std::sin(0.7 * i), 0);
    expect_pushed_out(floor, under, Eigen::Vector3d::UnitZ());
  }
}

// Triangles, normals, neighbours and the order in which they are visited decide a contact's bits. They are
// those of the first version of the tree, so recordings of scenes with meshes replay.
TEST(MeshTree, KeepsItsBits) {
  XXH3_state_t* const state = XXH3_createState();
  XXH3_64bits_reset(state);
  std::mt19937 random(1);
  for (int k = 0; k < 60; ++k) {
    const auto coordinate = [&] {
      const double step = k % 3 == 0 ? 1e-3 : 0.25;
      return (static_cast<int>(random() % (k % 3 == 0 ? 10'001 : 9)) - (k % 3 == 0 ? 5000 : 4)) * step;
    };
    world::TriangleMesh source;
    const unsigned vertices = 3 + random() % 200, triangles = random() % 600;
    for (unsigned i = 0; i < vertices; ++i) {
      const double x = coordinate(), y = coordinate(), z = coordinate();
      source.vertices.emplace_back(x, y, z);
    }
    for (unsigned i = 0; i < triangles; ++i) {
      const std::uint32_t a = random() % vertices, b = random() % vertices, c = random() % vertices;
      source.triangles.push_back({a, b, c});
    }
    const Mesh mesh(source);
    XXH3_64bits_update(state, mesh.triangles().data(), mesh.triangles().size() * sizeof(MeshTriangle));
    mesh.visit([](const Eigen::AlignedBox3d& box) { return box.min().x() < 0.01; },
               [&](std::uint32_t i) { XXH3_64bits_update(state, &i, sizeof i); });
  }
  EXPECT_EQ(XXH3_64bits_digest(state), 4128761035673946262u);
  XXH3_freeState(state);
}

}  // namespace
}  // namespace visum::collision::testing
