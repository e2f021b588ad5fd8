#include "clients/visum/run/course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace visum::run {
namespace {

TEST(Course, KeepsEveryStepOfAShortRun) {
  Course course;
  for (int i = 0; i < 10; ++i) course.add(0.1 * i, i * i);
  ASSERT_EQ(course.points().size(), 10u);
  EXPECT_EQ(course.points()[3], (CoursePoint{0.1 * 3, 9.0, 9.0}));
}

TEST(Course, OfALongRunKeepsEveryPeakInFewPoints) {
  Course course;
  for (int i = 0; i < 100'000; ++i) course.add(i, i == 77'777 ? 5.0 : i == 13 ? -3.0 : 0.0);
  EXPECT_LE(course.points().size(), Course::kMaxPoints);
  EXPECT_GE(course.points().size(), Course::kMaxPoints / 2);
  double lowest = 0.0, highest = 0.0, before = -1.0;
  for (const auto& point : course.points()) {
    EXPECT_GT(point.at_s, before);
    before = point.at_s;
    lowest = std::min(lowest, point.lowest);
    if (point.highest > highest) {
      EXPECT_NEAR(point.at_s, 77'777, 100'000 / 64.0) << "where it was";
      highest = point.highest;
    }
  }
  EXPECT_EQ(lowest, -3.0);
  EXPECT_EQ(highest, 5.0);
}

TEST(Course, WhatIsNoNumberIsLeftOut) {
  Course course;
  course.add(0.0, std::nan(""));
  course.add(1.0, std::numeric_limits<double>::infinity());
  course.add(2.0, 1.0);
  ASSERT_EQ(course.points().size(), 1u);
  EXPECT_EQ(course.points()[0].at_s, 2.0);
}

}  // namespace
}  // namespace visum::run
