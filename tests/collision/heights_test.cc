#include "server/collision/heights.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <utility>
#include <vector>

namespace visum::collision::testing {
namespace {

using Eigen::Vector3d;

struct Plane {
  Vector3d normal;
  double offset;
};

// Points in a ball, and planes that cut it.
class HeightsOf : public ::testing::TestWithParam<std::pair<double, double>> {
 protected:
  HeightsOf() {
    const auto [size, away] = GetParam();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(-1.0, 1.0);
    const auto any = [&] { return Vector3d(share(random), share(random), share(random)); };
    const Vector3d middle = away * any();
    for (int i = 0; i < 100; ++i) points_.push_back(middle + size * any());
    for (int i = 0; i < 100; ++i) {
      const Vector3d normal = any().normalized();
      planes_.push_back({normal, normal.dot(middle + size * any())});
    }
    limits_ = {0.0, 0.1 * size, -1e-5 * size};
  }

  static double height(const Vector3d& point, const Plane& plane) {
    return plane.normal.dot(point) - plane.offset;
  }

  std::vector<Vector3d> points_;
  std::vector<Plane> planes_;
  std::vector<double> limits_;
};

TEST_P(HeightsOf, FindAllThatIsAboveAndFewOthers) {
  Heights points(points_), planes(points_);
  for (const Vector3d& point : points_) points.add_point(point);
  for (const Plane& plane : planes_) planes.add_plane(plane.normal, plane.offset);
  std::size_t above = 0, found_points = 0, found_planes = 0;
  for (const double limit : limits_) {
    std::set<std::pair<std::size_t, std::size_t>> by_plane, by_point;
    for (std::size_t i = 0; i < planes_.size(); ++i)
      points.visit_points_above(planes_[i].normal, planes_[i].offset, limit,
                                [&](std::size_t point) { by_plane.emplace(point, i); });
    for (std::size_t i = 0; i < points_.size(); ++i)
      planes.visit_planes_below(points_[i], limit, [&](std::size_t plane) { by_point.emplace(i, plane); });
    for (std::size_t i = 0; i < points_.size(); ++i)
      for (std::size_t j = 0; j < planes_.size(); ++j) {
        if (!(height(points_[i], planes_[j]) > limit)) continue;
        ++above;
        EXPECT_TRUE(by_plane.contains({i, j}));
        EXPECT_TRUE(by_point.contains({i, j}));
      }
    found_points += by_plane.size();
    found_planes += by_point.size();
  }
  EXPECT_LE(found_points, above + 10);
  EXPECT_LE(found_planes, above + 10);
}

INSTANTIATE_TEST_SUITE_P(SizesAndPlaces, HeightsOf,
                         ::testing::Values(std::pair(1.0, 0.0), std::pair(1e-3, 1.0), std::pair(1e4, 1e6),
                                           std::pair(1e-6, 100.0)));

TEST(Heights, WhatIsDroppedIsFoundNoMoreAndTheOthersKeepTheirNumbers) {
  const std::vector<Vector3d> points{{0, 0, 0}, {1, 1, 1}};
  Heights planes(points);
  for (int i = 0; i < 40; ++i) planes.add_plane(Vector3d::UnitZ(), 0.02 * i);
  planes.drop(3);
  std::vector<std::size_t> found;
  planes.visit_planes_below({0, 0, 0.11}, 0.0, [&](std::size_t i) { found.push_back(i); });
  EXPECT_EQ(found, (std::vector<std::size_t>{0, 1, 2, 4, 5}));
  planes.clear();
  planes.visit_planes_below({0, 0, 1}, 0.0, [&](std::size_t) { FAIL(); });
}

}  // namespace
}  // namespace visum::collision::testing
