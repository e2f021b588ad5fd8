#include "server/world/point_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
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

// Each of these took hundreds of steps where the hash spread such coordinates badly.
TEST(PointNumbers, SpreadRoundCoordinatesAsWellAsOthers) {
  const auto slots_of = [](auto coordinate) {
    constexpr std::size_t kSlots = 1 << 15;
    std::set<std::size_t> slots;
    for (int i = 0; i < 128; ++i)
      for (int k = 0; k < 128; ++k) slots.insert(hash_of({coordinate(i), coordinate(k), 0.0}) & (kSlots - 1));
    return slots.size();
  };
  constexpr std::size_t kExpected = 12'893;  // 2^15 (1 - e^-0.5), where 2^14 points fall at random
  for (const auto spread :
       {slots_of([](int i) { return static_cast<double>(i); }), slots_of([](int i) { return 0.25 * i; }),
        slots_of([](int i) { return std::ldexp(1.0, 8 * (i - 64)); }),
        slots_of([](int i) { return 0.1 * i; })}) {
    EXPECT_GT(spread, kExpected * 97 / 100);
    EXPECT_LT(spread, kExpected * 103 / 100);
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
