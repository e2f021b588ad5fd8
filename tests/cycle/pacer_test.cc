#include "server/cycle/pacer.h"

#include <gtest/gtest.h>

namespace visum::cycle {
namespace {

using std::chrono::milliseconds;
using Clock = Pacer::Clock;

const Clock::time_point kStart{std::chrono::hours(1)};

TEST(Pacer, PutsTicksOnePeriodApart) {
  Pacer pacer(1'000'000);
  pacer.restart(kStart);
  EXPECT_EQ(pacer.due(), kStart + milliseconds(1));
  pacer.begin_tick(pacer.due());
  EXPECT_EQ(pacer.due(), kStart + milliseconds(2));
}

TEST(Pacer, DividesThePeriodByTheSpeed) {
  Pacer pacer(1'000'000);
  pacer.set_speed(0.1, kStart);
  pacer.restart(kStart);
  EXPECT_EQ(pacer.due(), kStart + milliseconds(10));
}

TEST(Pacer, WhatIsLeftOfAPeriodGoesByAtTheNewSpeed) {
  Pacer pacer(8'000'000);
  pacer.set_speed(1.0 / 1024, kStart);
  pacer.restart(kStart);
  ASSERT_EQ(pacer.due(), kStart + milliseconds(8192));
  pacer.set_speed(1.0, kStart + milliseconds(4096));
  EXPECT_EQ(pacer.due(), kStart + milliseconds(4096 + 4));
  pacer.set_speed(0.5, kStart + milliseconds(4096 + 6));
  EXPECT_EQ(pacer.due(), kStart + milliseconds(4096 + 4)) << "what is owed stays owed";
}

TEST(Pacer, ALittleLateCostsNothing) {
  Pacer pacer(1'000'000);
  pacer.restart(kStart);
  pacer.begin_tick(kStart + milliseconds(2));  // one whole period late, no more
  EXPECT_EQ(pacer.overruns(), 0u);
  EXPECT_EQ(pacer.due(), kStart + milliseconds(2)) << "the schedule must not drift";
}

TEST(Pacer, AStallIsCountedAndNotCaughtUpInABurst) {
  Pacer pacer(10'000'000);
  pacer.restart(kStart);
  const auto late = kStart + milliseconds(10 + 35);
  pacer.begin_tick(late);
  EXPECT_EQ(pacer.overruns(), 1u);
  EXPECT_EQ(pacer.due(), late + milliseconds(10));
}

TEST(Pacer, OwesNothingAfterAPause) {
  Pacer pacer(1'000'000);
  pacer.restart(kStart);
  pacer.begin_tick(pacer.due());
  pacer.restart(kStart + std::chrono::hours(1));
  pacer.begin_tick(pacer.due());
  EXPECT_EQ(pacer.overruns(), 0u);
}

}  // namespace
}  // namespace visum::cycle
