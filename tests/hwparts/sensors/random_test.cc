#include "hwparts/sensors/random.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/hwparts/sensors/bench.h"

namespace visum::sensors {
namespace {

constexpr int kMany = 200'000;

TEST(SensorRandom, LogarithmIsThatOfTheMathematicsLibrary) {
  for (double x = 1e-300; x < 1e300; x *= 1.37)
    ASSERT_NEAR(portable_log(x), std::log(x), 4e-16 * std::max(1.0, std::abs(std::log(x)))) << x;
  EXPECT_EQ(portable_log(1.0), 0.0);
}

TEST(SensorRandom, TheSameSeedAndNameGiveTheSameNumbers) {
  Random a(7, "front"), b(7, "front");
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a.normal(), b.normal());
}

TEST(SensorRandom, AnotherSeedOrNameGivesOthers) {
  EXPECT_NE(Random(7, "front").uniform(), Random(8, "front").uniform());
  EXPECT_NE(Random(7, "front").uniform(), Random(7, "rear").uniform());
}

TEST(SensorRandom, UniformNumbersAreUniform) {
  Random random(1, "a");
  std::vector<double> numbers;
  for (int i = 0; i < kMany; ++i) numbers.push_back(random.uniform());
  const auto [mean, deviation] = test::statistics_of(numbers);
  EXPECT_NEAR(mean, 0.5, 5 * deviation / std::sqrt(kMany));
  EXPECT_NEAR(deviation, std::sqrt(1.0 / 12), 1e-3);
  for (const double x : numbers) ASSERT_TRUE(x >= 0.0 && x < 1.0);
}

// The shares beyond 1, 2 and 3 deviations. Each must be right within five of its own standard errors.
TEST(SensorRandom, NormalNumbersAreNormal) {
  Random random(1, "a");
  std::vector<double> numbers;
  for (int i = 0; i < kMany; ++i) numbers.push_back(random.normal());
  const auto [mean, deviation] = test::statistics_of(numbers);
  EXPECT_NEAR(mean, 0.0, 5 / std::sqrt(kMany));
  EXPECT_NEAR(deviation, 1.0, 5 / std::sqrt(2.0 * kMany));
  for (const double limit : {1.0, 2.0, 3.0}) {
    const double expected = std::erfc(limit / std::sqrt(2.0));
    const auto beyond = std::ranges::count_if(numbers, [&](double x) { return std::abs(x) > limit; });
    EXPECT_NEAR(static_cast<double>(beyond) / kMany, expected, 5 * std::sqrt(expected / kMany)) << limit;
  }
}

TEST(SensorRandom, GoesOnWhereItWasSaved) {
  Random random(3, "a");
  random.normal();
  std::vector<std::byte> bytes;
  {
    hwparts::StateWriter writer(bytes);
    random.save(writer);
  }
  const double next = random.normal();
  Random other(9, "b");
  hwparts::StateReader reader(bytes);
  other.load(reader);
  EXPECT_EQ(other.normal(), next);
}

}  // namespace
}  // namespace visum::sensors
