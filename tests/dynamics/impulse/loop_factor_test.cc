#include "server/dynamics/impulse/loop_factor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace visum::dynamics::impulse {
namespace {

// The rows of a chain of springs, tridiagonal, with the row `twice` repeated right behind itself.
struct Chain {
  static constexpr std::size_t kCount = 5;
  static double response(std::size_t i, std::size_t j) { return i == j ? 2.0 : i == j + 1 ? -1.0 : 0.0; }
};

TEST(LoopFactor, SolvesABandWithinItsEnvelope) {
  LoopFactor factor;
  for (std::size_t i = 0; i < Chain::kCount; ++i) {
    const std::size_t first = i > 0 ? i - 1 : 0;
    factor.add_block(first);
    factor.add_row(2.0);
    for (std::size_t j = first; j <= i; ++j) factor.at(i, j) = Chain::response(i, j);
  }
  factor.factor();
  EXPECT_EQ(factor.rank(), Chain::kCount);
  std::vector<double> b{1.0, 0.0, 0.0, 0.0, 1.0};  // for x = 1
  factor.solve(b);
  for (const double x : b) EXPECT_NEAR(x, 1.0, 1e-14);
}

// b = A x for x = (1, 2, 2, 3). A has rank 3: rows 1 and 2 are the same.
TEST(LoopFactor, ARowThatSaysTheSameAgainIsLeftOutAndStillTrue) {
  const std::array<std::array<double, 4>, 4> A{{{2, 1, 1, 0}, {1, 2, 2, 1}, {1, 2, 2, 1}, {0, 1, 1, 2}}};
  LoopFactor factor;
  factor.add_block(0);
  for (std::size_t i = 0; i < 4; ++i) {
    factor.add_row(A[i][i]);
    for (std::size_t j = 0; j <= i; ++j) factor.at(i, j) = A[i][j];
  }
  factor.factor();
  EXPECT_EQ(factor.rank(), 3u);
  const std::array<double, 4> wanted{6.0, 12.0, 12.0, 10.0};
  std::vector<double> x(wanted.begin(), wanted.end());
  factor.solve(x);
  EXPECT_EQ(x[1] * x[2], 0.0) << "one of the two";
  for (std::size_t i = 0; i < 4; ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < 4; ++j) sum += A[i][j] * x[j];
    EXPECT_NEAR(sum, wanted[i], 1e-13);
  }
}

// Two blocks. The second begins with a row that nearly repeats the first block. Taken first, it would have to
// carry what the row after it says properly.
TEST(LoopFactor, ARowThatIsNearlySaidComesLastInItsBlock) {
  constexpr double kNearly = 1e-7;
  const std::array<std::array<double, 3>, 3> J{{{1, 0, 0}, {1, kNearly, 0}, {0, 1, 1}}};
  LoopFactor factor;
  for (std::size_t i = 0; i < 3; ++i) {
    if (i < 2) factor.add_block(0);
    factor.add_row(2.0);
    for (std::size_t j = 0; j <= i; ++j)
      factor.at(i, j) = J[i][0] * J[j][0] + J[i][1] * J[j][1] + J[i][2] * J[j][2];
  }
  factor.factor();
  EXPECT_EQ(factor.rank(), 2u);
  EXPECT_GT(factor.least_share(), 0.4);
  std::vector<double> b{1.0, 1.0, 2.0};
  factor.solve(b);
  EXPECT_NEAR(b[0], 1.0, 1e-12);
  EXPECT_EQ(b[1], 0.0);
  EXPECT_NEAR(b[2], 1.0, 1e-12);
}

TEST(LoopFactor, WhatJointsHoldFastToRoundingIsLeftOut) {
  LoopFactor factor;
  factor.add_block(0);
  factor.add_row(1.0);
  factor.at(0, 0) = 1e-17;
  factor.factor();
  EXPECT_EQ(factor.rank(), 0u);
  std::vector<double> b{1.0};
  factor.solve(b);
  EXPECT_EQ(b[0], 0.0);
}

}  // namespace
}  // namespace visum::dynamics::impulse
