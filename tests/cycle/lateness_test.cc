#include "server/cycle/lateness.h"

#include <gtest/gtest.h>

namespace visum::cycle {
namespace {

TEST(Lateness, KnowsNothingBeforeTheFirst) {
  LatenessHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0);
  EXPECT_EQ(histogram.max(), 0);
}

TEST(Lateness, QuantilesAreRightToNinePercent) {
  LatenessHistogram histogram;
  for (int i = 1; i <= 100'000; ++i) histogram.add(i);
  for (double q : {0.01, 0.1, 0.5, 0.9, 0.999}) {
    const auto exact = q * 100'000;
    EXPECT_GE(histogram.quantile(q), exact * 0.999) << q;
    EXPECT_LE(histogram.quantile(q), exact * 1.13) << q;
  }
  EXPECT_EQ(histogram.quantile(1.0), 100'000);
  EXPECT_EQ(histogram.max(), 100'000);
}

TEST(Lateness, TakesWhatIsEarlyAsOnTimeAndWhatIsHugeAsItIs) {
  LatenessHistogram histogram;
  histogram.add(-5);
  EXPECT_EQ(histogram.quantile(1.0), 0);
  histogram.add(std::int64_t{1} << 60);
  EXPECT_EQ(histogram.max(), std::int64_t{1} << 60);
}

}  // namespace
}  // namespace visum::cycle
