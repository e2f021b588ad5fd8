#include "hwparts/drive/portable_tanh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace visum::drive {
namespace {

TEST(PortableTanh, AgreesWithTheLibraryEverywhere) {
  for (int i = -25000; i <= 25000; ++i) {
    const double x = i * 1e-3 + 1e-4;
    EXPECT_NEAR(portable_tanh(x), std::tanh(x), 1e-15) << x;
  }
}

TEST(PortableTanh, KeepsItsRelativeAccuracyForSmallArguments) {
  for (double x = 1e-300; x < 1.0; x *= 7.3) {
    EXPECT_NEAR(portable_tanh(x) / std::tanh(x), 1.0, 1e-14) << x;
  }
}

TEST(PortableTanh, IsOddBoundedAndMonotonousUpToRounding) {
  double before = -1.0;
  for (double x = -30.0; x <= 30.0; x += 0.01) {
    EXPECT_EQ(portable_tanh(-x), -portable_tanh(x));
    EXPECT_GE(portable_tanh(x), before - 2.3e-16);
    EXPECT_LE(std::abs(portable_tanh(x)), 1.0);
    before = portable_tanh(x);
  }
  EXPECT_EQ(portable_tanh(1e308), 1.0);
  EXPECT_EQ(portable_tanh(-std::numeric_limits<double>::infinity()), -1.0);
  EXPECT_TRUE(std::isnan(portable_tanh(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::signbit(portable_tanh(-0.0)));
}

}  // namespace
}  // namespace visum::drive
