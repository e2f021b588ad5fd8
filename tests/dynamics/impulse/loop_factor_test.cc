#include "server/dynamics/impulse/loop_factor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace visum::dynamics::impulse {
namespace {

// The rows of a chain of springs, tridiagonal, with the row `twice` said again right after itself.
struct Chain {
  static constexpr std::size_t kCount = 5;
  static double response(std::size_t i, std::size_t j) { return i == j ? 2.0 : i == j + 1 ? -1.0 : 0.0; }
};

TEST(LoopFactor, SolvesABandWithinItsEnvelope) {
  LoopFactor factor;
  for (std::size_t i = 0; i < Chain::kCount; ++i) {
    const std::size_t first = i > 0 ? i - 1 : 0;
    factor.add(first, 2.0);
    for (std::size_t j = first; j <= i; ++j) factor.at(i, j) = Chain::response(i, j);
  }
  factor.factor();
  EXPECT_EQ(factor.rank(), Chain::kCount);
  std::vector<double> b{1.0, 0.0, 0.0, 0.0, 1.0};  // of x = 1
  factor.solve(b);
  for (const double x : b) EXPECT_NEAR(x, 1.0, 1e-14);
}

// b = A x for x = (1, 2, 2, 3), A of rank 3: rows 1 and 2 are the same.
TEST(LoopFactor, ARowThatSaysTheSameAgainIsLeftOutAndStillTrue) {
  const std::array<std::array<double, 4>, 4> A{{{2, 1, 1, 0}, {1, 2, 2, 1}, {1, 2, 2, 1}, {0, 1, 1, 2}}};
  LoopFactor factor;
  for (std::size_t i = 0; i < 4; ++i) {
    factor.add(0, A[i][i]);
    for (std::size_t j = 0; j <= i; ++j) factor.at(i, j) = A[i][j];
  }
  factor.factor();
  EXPECT_EQ(factor.rank(), 3u);
  const std::array<double, 4> wanted{6.0, 12.0, 12.0, 10.0};
  std::vector<double> x(wanted.begin(), wanted.end());
  factor.solve(x);
  EXPECT_EQ(x[2], 0.0);
  for (std::size_t i = 0; i < 4; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < 4; ++j) sum += A[i][j] * x[j];
    EXPECT_NEAR(sum, wanted[i], 1e-13);
  }
}

TEST(LoopFactor, WhatJointsHoldFastToRoundingIsLeftOut) {
  LoopFactor factor;
  factor.add(0, 1.0);
  factor.at(0, 0) = 1e-17;
  factor.factor();
  EXPECT_EQ(factor.rank(), 0u);
  std::vector<double> b{1.0};
  factor.solve(b);
  EXPECT_EQ(b[0], 0.0);
}

}  // namespace
}  // namespace visum::dynamics::impulse
