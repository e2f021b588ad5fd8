#include "hwparts/drive/ramp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace visum::drive {
namespace {

constexpr double kTick = 0.001;

// The position after t seconds on the trapezoid from rest over a distance d > 0, in closed form.
double trapezoid(double d, double v, double a, double t) {
  const double peak = std::min(v, std::sqrt(a * d));
  const double ramp = peak / a, cruise = d / peak - ramp, total = 2.0 * ramp + cruise;
  if (t >= total) return d;
  if (t <= ramp) return 0.5 * a * t * t;
  if (t <= ramp + cruise) return peak * (t - 0.5 * ramp);
  return d - 0.5 * a * (total - t) * (total - t);
}

TEST(Ramp, IsTheTrapezoidOfTheTextbook) {
  for (const double distance : {1e-6, 0.01, 0.3, 2.0}) {
    for (const double direction : {1.0, -1.0}) {
      Setpoint point{0.5, 0.0, RampPhase::kEnd};
      for (int k = 1; k < 8000; ++k) {
        point = ramp_to(point, 0.5 + direction * distance, 0.4, 1.7, kTick);
        ASSERT_NEAR((point.position - 0.5) * direction, trapezoid(distance, 0.4, 1.7, k * kTick), 1e-11) << k;
      }
      EXPECT_EQ(point.position, 0.5 + direction * distance);
    }
  }
}

TEST(Ramp, ArrivesExactlyAndStays) {
  Setpoint point{0.1, 0.0, RampPhase::kEnd};
  const double target = 0.7123456789;
  for (int k = 0; k < 5000; ++k) point = ramp_to(point, target, 0.4, 1.7, kTick);
  EXPECT_EQ(point.position, target);
  EXPECT_EQ(point.speed, 0.0);
  EXPECT_EQ(point.phase, RampPhase::kEnd);
}

TEST(Ramp, GoesThroughItsPhasesInOrder) {
  Setpoint point;
  std::vector<RampPhase> phases{point.phase};
  for (int k = 0; k < 5000; ++k) {
    point = ramp_to(point, 1.0, 0.4, 1.7, kTick);
    if (point.phase != phases.back()) phases.push_back(point.phase);
  }
  const std::vector<RampPhase> expected{RampPhase::kEnd, RampPhase::kAccelerating, RampPhase::kSteady,
                                        RampPhase::kDecelerating, RampPhase::kEnd};
  EXPECT_EQ(phases, expected);
}

TEST(Ramp, DeceleratesToALowerMaximumSpeed) {
  Setpoint point;
  for (int k = 0; k < 500; ++k) point = ramp_to(point, 10.0, 0.4, 1.7, kTick);
  ASSERT_EQ(point.speed, 0.4);
  const auto before = point;
  point = ramp_to(point, 10.0, 0.1, 1.7, kTick);
  EXPECT_NEAR(point.speed, 0.4 - 1.7 * kTick, 1e-12);
  EXPECT_EQ(point.phase, RampPhase::kDecelerating);
  while (point.phase == RampPhase::kDecelerating) point = ramp_to(point, 10.0, 0.1, 1.7, kTick);
  EXPECT_EQ(point.speed, 0.1);
  EXPECT_GT(point.position, before.position);
}

TEST(Ramp, BrakesAndComesBackWhenTheTargetIsTooNear) {
  Setpoint point;
  for (int k = 0; k < 500; ++k) point = ramp_to(point, 10.0, 0.4, 1.7, kTick);
  const double target = point.position + 0.01;  // braking takes 0.047
  double furthest = point.position;
  for (int k = 0; k < 2000; ++k) {
    point = ramp_to(point, target, 0.4, 1.7, kTick);
    furthest = std::max(furthest, point.position);
  }
  EXPECT_NEAR(furthest, target - 0.01 + 0.4 * 0.4 / (2.0 * 1.7), 1e-6);
  EXPECT_EQ(point.position, target);
}

TEST(Ramp, MaximumSpeedZeroStopsAndStands) {
  Setpoint point;
  for (int k = 0; k < 500; ++k) point = ramp_to(point, 10.0, 0.4, 1.7, kTick);
  const double stops_at = point.position + 0.4 * 0.4 / (2.0 * 1.7);
  for (int k = 0; k < 500; ++k) point = ramp_to(point, 10.0, 0.0, 1.7, kTick);
  EXPECT_EQ(point.speed, 0.0);
  EXPECT_NEAR(point.position, stops_at, 1e-12);
  EXPECT_EQ(point.phase, RampPhase::kEnd);
}

TEST(Ramp, StopsWithinItsBrakingDistance) {
  Setpoint point{1.0, -0.4, RampPhase::kSteady};
  int ticks = 0;
  for (; point.speed != 0.0; ++ticks) point = ramp_stop(point, 1.7, kTick);
  EXPECT_NEAR(point.position, 1.0 - 0.4 * 0.4 / (2.0 * 1.7), 1e-12);
  EXPECT_EQ(ticks, static_cast<int>(std::ceil(0.4 / 1.7 / kTick)));
  const auto after = ramp_stop(point, 1.7, kTick);
  EXPECT_EQ(after.position, point.position);
  EXPECT_EQ(after.phase, RampPhase::kEnd);
}

// Targets and maximum speeds change at any tick. The setpoint never jumps, and keeps within the speed and the
// acceleration that were asked for.
class RampFuzz : public testing::TestWithParam<int> {};

TEST_P(RampFuzz, NeverExceedsSpeedOrAccelerationAndArrivesExactly) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double h = GetParam() % 2 == 0 ? 0.001 : 0.005;
  const double a = 0.2 + 5.0 * unit(random);
  Setpoint point;
  double target = 0.0, vmax = 1.0, allowed = 0.0;
  for (int k = 0; k < 20000; ++k) {
    if (unit(random) < 0.01)
      target = point.position + (unit(random) < 0.3 ? 0.01 : 2.0) * (unit(random) - 0.5);
    if (unit(random) < 0.005) vmax = unit(random);
    const auto before = point;
    point = ramp_to(before, target, vmax, a, h);
    allowed = std::max(
        vmax, std::abs(before.speed) - a * h);  // above the new maximum only while braking down to it
    ASSERT_LE(std::abs(point.speed), allowed * (1.0 + 1e-9) + 1e-12) << k;
    ASSERT_LE(std::abs(point.speed - before.speed), a * h * (1.0 + 1e-6) + 1e-12) << k;
    // The acceleration is at most a at any time in the tick, so the distance is near that of the mean speed.
    const double way = point.position - before.position;
    ASSERT_LE(std::abs(way - 0.5 * h * (point.speed + before.speed)), 0.25 * a * h * h * (1.0 + 1e-6) + 1e-12)
        << k;
  }
  for (int k = 0; k < 200000 && point.phase != RampPhase::kEnd; ++k)
    point = ramp_to(point, target, 0.5, a, h);
  EXPECT_EQ(point.position, target);
  EXPECT_EQ(point.speed, 0.0);
}

TEST_P(RampFuzz, NeverOvershootsATargetThatItCanStopBefore) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()) + 1000);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const double a = 0.2 + 5.0 * unit(random), v0 = unit(random), vmax = 0.05 + unit(random);
    const double target = v0 * v0 / (2.0 * a) + unit(random) * unit(random);
    Setpoint point{0.0, v0, RampPhase::kSteady};
    for (int k = 0; k < 60000 && (point.position != target || point.speed != 0.0); ++k) {
      point = ramp_to(point, target, vmax, a, kTick);
      ASSERT_LE(point.position, target + 1e-12);
      ASSERT_GE(point.speed, -1e-6);
    }
    ASSERT_EQ(point.position, target);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RampFuzz, testing::Range(1, 13));

TEST(Ramp, SurvivesEveryTargetThatIsANumber) {
  for (const double target : {1e308, -1e308, 5e-324, -0.0}) {
    Setpoint point;
    for (int k = 0; k < 100; ++k) point = ramp_to(point, target, 0.4, 1.7, kTick);
    EXPECT_TRUE(std::isfinite(point.position)) << target;
    EXPECT_LE(std::abs(point.speed), 0.4) << target;
  }
}

}  // namespace
}  // namespace visum::drive
