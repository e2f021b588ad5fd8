#include "server/world/point_numbers.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

namespace visum::world {
namespace {

TEST(PointNumbers, AreThoseOfAMap) {
  std::mt19937 random(1);
  for (const int kinds : {1, 3, 20, 1000}) {
    PointNumbers numbers;
    std::map<std::tuple<double, double, double>, std::uint32_t> known;
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 5000; ++i) {
      const auto coordinate = [&] { return (static_cast<int>(random() % kinds) - kinds / 2) * 0.1; };
      const Eigen::Vector3d point(coordinate(), coordinate(), coordinate());
      const auto [entry, is_new] =
          known.try_emplace({point.x(), point.y(), point.z()}, static_cast<std::uint32_t>(known.size()));
      if (is_new) points.push_back(point);
      ASSERT_EQ(numbers.number(point), entry->second);
    }
    EXPECT_EQ(numbers.take_points(), points);
  }
}

TEST(PointNumbers, NegativeZeroIsZeroAndTheFirstStays) {
  PointNumbers numbers;
  EXPECT_EQ(numbers.number({-0.0, 1, 0}), 0u);
  EXPECT_EQ(numbers.number({0.0, 1, -0.0}), 0u);
  EXPECT_TRUE(std::signbit(numbers.take_points().at(0).x()));
  EXPECT_EQ(numbers.number({5, 5, 5}), 0u) << "it is empty again";
}

}  // namespace
}  // namespace visum::world
