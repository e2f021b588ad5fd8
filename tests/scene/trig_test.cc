#include "protocol/config/trig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace visum::config {
namespace {

constexpr double kUlps = 3.0 * std::numeric_limits<double>::epsilon();

TEST(Trig, SineAndCosineAgreeWithTheLibraryWithinRounding) {
  for (int i = -4000; i <= 4000; ++i) {
    const double x = 0.00317 * i * std::abs(i) / 10.0;
    const SinCos got = sin_cos(x);
    EXPECT_NEAR(got.sin, std::sin(x), kUlps) << x;
    EXPECT_NEAR(got.cos, std::cos(x), kUlps) << x;
  }
}

TEST(Trig, SineOfASmallAngleKeepsItsRelativeAccuracy) {
  for (const double x : {1e-300, 1e-20, 1e-9, 1e-5, 0.01, -0.3})
    EXPECT_NEAR(sin_cos(x).sin / std::sin(x), 1.0, kUlps) << x;
}

TEST(Trig, ArcTangentAgreesWithTheLibraryInAllQuadrants) {
  for (int i = 0; i < 1000; ++i) {
    const double angle = -3.14159 + 6.28318 * i / 999.0, r = std::pow(10.0, i % 7 - 3);
    const double y = r * std::sin(angle), x = r * std::cos(angle);
    EXPECT_NEAR(arc_tangent(y, x), std::atan2(y, x), 2.0 * kUlps) << y << " " << x;
  }
  EXPECT_EQ(arc_tangent(0.0, 0.0), 0.0);
  EXPECT_EQ(arc_tangent(1.0, 0.0), std::atan2(1.0, 0.0));
  EXPECT_EQ(arc_tangent(-1.0, 0.0), std::atan2(-1.0, 0.0));
  EXPECT_EQ(arc_tangent(0.0, -1.0), std::atan2(0.0, -1.0));
}

TEST(Trig, WhatIsNoNumberStaysNone) {
  EXPECT_TRUE(std::isnan(sin_cos(std::nan("")).sin));
  EXPECT_TRUE(std::isnan(sin_cos(1e300).cos));
  EXPECT_TRUE(std::isnan(arc_tangent(std::nan(""), 1.0)));
}

}  // namespace
}  // namespace visum::config
