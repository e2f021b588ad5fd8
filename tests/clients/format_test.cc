#include "clients/visum/common/format.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

namespace visum::cli {
namespace {

TEST(Format, ExactReadsBackToTheSameBits) {
  for (const double number : {0.1, -0.0, 1e-310, 1.7976931348623157e308, 0.30000000000000004}) {
    EXPECT_EQ(std::strtod(exact(number).c_str(), nullptr), number);
  }
  EXPECT_EQ(exact(0.5), "0.5");
}

TEST(Format, FixedHoldsTheLargestNumber) {
  EXPECT_EQ(fixed(std::numeric_limits<double>::max(), 3).size(), 309u + 4u);
  EXPECT_EQ(fixed(-1.0 / 3.0, 3), "-0.333");
}

TEST(Format, FixedHasNoNegativeZero) {
  EXPECT_EQ(fixed(-4.94e-324, 6), "0.000000");
  EXPECT_EQ(fixed(-0.0006, 3), "-0.001");
}

TEST(Format, ReadableHasNoDigitsOfRounding) {
  EXPECT_EQ(readable(-8.370000000000001), "-8.37");
  EXPECT_EQ(readable(-4.94e-324), "0");
  EXPECT_EQ(readable(16777217.0), "16777217");
  EXPECT_EQ(readable(1.0 / 3.0), "0.333333");
  EXPECT_EQ(readable(1e300), "1e+300");
  EXPECT_EQ(readable(std::numeric_limits<double>::infinity()), "inf");
}

TEST(Format, SecondsAndHash) {
  EXPECT_EQ(seconds(1'250'000'000), "1.250 s");
  EXPECT_EQ(hex(0x9fu), "000000000000009f");
}

TEST(Format, TablePadsAllButTheLastColumn) {
  Table table;
  table.row({"a", "bb", "c"});
  table.row({"aaa", "b", "cc"});
  EXPECT_EQ(table.text(" "), " a    bb  c\n aaa  b   cc\n");
}

}  // namespace
}  // namespace visum::cli
