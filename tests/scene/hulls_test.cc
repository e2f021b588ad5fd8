#include "server/scene/hulls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace visum::scene::testing {
namespace {

// In any order of the vertices, and where several are as far.
TEST(Hulls, AThinHullHasTheFirstOfTheFarthestVerticesInEachDirection) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int kind = 0; kind < 4; ++kind) {
    world::TriangleMesh mesh;
    for (int i = 0; i < 1500; ++i) {
      Eigen::Vector3d point(normal(random), normal(random), normal(random));
      if (kind == 1) point = point.array().round();
      if (kind == 2) point = Eigen::Vector3d(std::cos(0.1 * i), std::sin(0.1 * i), 1e-3 * i);
      if (kind == 3) point += Eigen::Vector3d(1e5, -1e3, 0);
      mesh.vertices.push_back(point);
    }
    std::vector<Eigen::Vector3d> wanted;
    for (const Eigen::Vector3d& direction : ball_mesh().vertices) {
      const auto farthest =
          std::ranges::max_element(mesh.vertices, {}, [&](const auto& v) { return direction.dot(v); });
      if (std::ranges::find(wanted, *farthest) == wanted.end()) wanted.push_back(*farthest);
    }
    EXPECT_EQ(thin_hull(mesh).vertices, wanted) << kind;
  }
}

}  // namespace
}  // namespace visum::scene::testing
