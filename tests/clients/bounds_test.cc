#include "clients/visum/run/bounds.h"

#include <gtest/gtest.h>

#include <limits>

namespace visum::run {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Bounds below(double x) {
  Bounds bounds;
  bounds.below = x;
  return bounds;
}

TEST(Bounds, BelowAndAboveAreStrict) {
  EXPECT_TRUE(holds(below(1.0), 0.999));
  EXPECT_FALSE(holds(below(1.0), 1.0));
  Bounds above;
  above.above = 1.0;
  EXPECT_FALSE(holds(above, 1.0));
  EXPECT_TRUE(holds(above, 1.001));
}

TEST(Bounds, BetweenAndEqualsIncludeTheirLimits) {
  Bounds between;
  between.between = {1.0, 2.0};
  EXPECT_TRUE(holds(between, 1.0));
  EXPECT_TRUE(holds(between, 2.0));
  EXPECT_FALSE(holds(between, 2.1));
  Bounds equals;
  equals.equals = 1.0;
  EXPECT_TRUE(holds(equals, 1.0));
  EXPECT_FALSE(holds(equals, 1.0 + 1e-15));
  equals.within = 0.5;
  EXPECT_TRUE(holds(equals, 1.5));
  EXPECT_FALSE(holds(equals, 1.6));
}

TEST(Bounds, AllThatAreGivenMustHold) {
  Bounds both = below(2.0);
  both.above = 1.0;
  EXPECT_TRUE(holds(both, 1.5));
  EXPECT_FALSE(holds(both, 0.5));
  EXPECT_FALSE(holds(both, 2.5));
  EXPECT_DOUBLE_EQ(margin(both, 1.25), 0.25);
  EXPECT_DOUBLE_EQ(margin(both, 2.5), -0.5);
}

TEST(Bounds, WhatIsNoNumberHoldsNothing) {
  Bounds everything;
  everything.between = {-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  EXPECT_FALSE(holds(everything, kNan));
  EXPECT_FALSE(holds(below(1.0), kNan));
  EXPECT_LT(margin(below(1.0), kNan), -1e308);
}

TEST(Bounds, ReadAsASentence) {
  Bounds bounds = below(2.0);
  bounds.above = -1.0;
  EXPECT_EQ(to_text(bounds, "m"), "below 2 and above -1 m");
  Bounds equals;
  equals.equals = 0.24;
  equals.within = 0.002;
  EXPECT_EQ(to_text(equals, ""), "equal to 0.24 within 0.002");
}

}  // namespace
}  // namespace visum::run
