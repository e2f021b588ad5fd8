// A trajectory on the blackboard of a group of servos, followed by the arm's drives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "hwparts/servo_group/part_state.h"
#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

using testing::HasSubstr;

constexpr std::size_t kBoard = 1;
constexpr std::size_t kRow = 10;  // time, seven angles, two fingers

// Way-points of joint 1 alone; the other joints stay at 0, the fingers where they are.
std::vector<double> rows_of(PartBench& bench, const std::vector<std::pair<double, double>>& points) {
  std::vector<double> rows;
  const double finger = bench.out("Actual Finger Position 1");
  for (const auto& [time, angle] : points) {
    rows.push_back(time);
    rows.push_back(angle);
    rows.insert(rows.end(), 6, 0.0);
    rows.insert(rows.end(), 2, finger);
  }
  return rows;
}

std::string write(PartBench& bench, const std::vector<double>& rows, std::uint64_t offset = 0) {
  return bench.part->write_blackboard(kBoard, offset, std::as_bytes(std::span(rows))).value_or("done");
}

TEST(Trajectory, IsDescribedAsABlackboardWithARowForEachWayPoint) {
  auto bench = arm_bench();
  const auto& board = bench.part->description().blackboards.at(kBoard);
  EXPECT_EQ(board.name, "Trajectory");
  EXPECT_TRUE(board.writable);
  EXPECT_EQ(board.element_size, kRow * sizeof(double));
}

TEST(Trajectory, GoesThroughItsWayPointsInTime) {
  auto bench = arm_bench();
  bench.tick();
  EXPECT_EQ(write(bench, rows_of(bench, {{1.5, 0.4}, {3.0, 0.8}, {5.5, 0.2}})), "done");
  bench.run(1.5);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.4, 0.02);
  EXPECT_GT(bench.out("Actual Speed 1"), 0.2);  // it does not stop on the way
  bench.run(1.5);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.8, 0.02);
  bench.run(2.7);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.2, 1e-3);
  EXPECT_NEAR(bench.out("Actual Speed 1"), 0.0, 5e-3);
  EXPECT_NEAR(bench.out("Actual Angle 2"), 0.0, 1e-3);
  bench.run(1.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.2, 1e-3);  // and it stays there
}

TEST(Trajectory, EndsWhenAPortCommandsADrive) {
  auto bench = arm_bench();
  bench.tick();
  EXPECT_EQ(write(bench, rows_of(bench, {{6.0, 1.5}})), "done");
  bench.run(1.0);
  bench.in("Desired Angle 2") = 0.3;
  bench.run(0.5);
  const double stood = bench.out("Actual Angle 1");
  bench.run(5.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), stood, 1e-3);
  EXPECT_LT(stood, 0.7);
  EXPECT_NEAR(bench.out("Actual Angle 2"), 0.3, 1e-3);
}

TEST(Trajectory, AnEmptyOneAHaltAndALostControllerEndIt) {
  for (const int way : {0, 1, 2}) {
    auto bench = arm_bench();
    bench.tick();
    EXPECT_EQ(write(bench, rows_of(bench, {{6.0, 1.5}})), "done");
    bench.run(1.0);
    if (way == 0) {
      EXPECT_EQ(write(bench, {}), "done");
    }
    if (way == 1) bench.bump("Halt");
    if (way == 2) bench.part->controller_lost();
    bench.run(0.5);
    const double stood = bench.out("Actual Angle 1");
    bench.run(5.0);
    EXPECT_NEAR(bench.out("Actual Angle 1"), stood, 1e-3) << way;
    EXPECT_LT(stood, 0.7) << way;
    if (way != 0) {
      EXPECT_THAT(write(bench, rows_of(bench, {{6.0, 1.5}})), HasSubstr("may not move now"));
    }
  }
}

TEST(Trajectory, RefusesWhatCannotBeAndKeepsTheOldOne) {
  auto bench = arm_bench();
  bench.tick();
  const auto good = rows_of(bench, {{1.5, 0.4}, {3.0, 0.8}});
  EXPECT_EQ(write(bench, good), "done");
  EXPECT_THAT(write(bench, {1.0, 2.0}), HasSubstr("a row has 10 doubles"));
  EXPECT_THAT(write(bench, rows_of(bench, {{0.0, 0.4}})), HasSubstr("row 1: its time"));
  EXPECT_THAT(write(bench, rows_of(bench, {{1.0, 0.4}, {1.0, 0.5}})), HasSubstr("row 2: its time"));
  EXPECT_THAT(write(bench, rows_of(bench, {{1.0, 99.0}})),
              HasSubstr("row 1: Desired Angle 1 must be within"));
  EXPECT_THAT(write(bench, rows_of(bench, {{1.0, std::nan("")}})), HasSubstr("Desired Angle 1"));
  EXPECT_THAT(write(bench, rows_of(bench, {{0.1, 1.5}})),
              HasSubstr("row 1: Desired Angle 1 needs the speed"));
  EXPECT_THAT(write(bench, rows_of(bench, {{0.1, 0.12}})),
              HasSubstr("row 1: Desired Angle 1 needs the acceleration"));
  EXPECT_THAT(write(bench, std::vector<double>(kRow * 2000, 0.0)), HasSubstr("at most 1024"));
  EXPECT_THAT(write(bench, good, 7777), HasSubstr("beyond the content"));
  const auto kept = bench.part->read_blackboard(kBoard);
  ASSERT_EQ(kept.size(), good.size() * sizeof(double));
  EXPECT_EQ(std::memcmp(kept.data(), good.data(), kept.size()), 0);
}

TEST(Trajectory, TakesARowAtItsOffset) {
  auto bench = arm_bench();
  bench.tick();
  EXPECT_EQ(write(bench, rows_of(bench, {{1.2, 0.3}})), "done");
  EXPECT_EQ(write(bench, rows_of(bench, {{3.0, 0.6}}), kRow * sizeof(double)), "done");
  bench.run(3.2);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.6, 1e-3);
}

TEST(Trajectory, GoesOnFromASavedState) {
  auto bench = arm_bench(), other = arm_bench();
  bench.tick();
  other.tick();
  EXPECT_EQ(write(bench, rows_of(bench, {{1.5, 0.4}, {3.0, 0.8}})), "done");
  bench.run(0.7331);
  std::vector<std::byte> saved;
  {
    hwparts::StateWriter to(saved);
    bench.part->save(to);
  }
  hwparts::StateReader from(saved);
  other.part->load(from);
  EXPECT_TRUE(from.at_end());
  other.plants = bench.plants;
  for (int i = 0; i < 1500; ++i) {
    bench.tick();
    other.tick();
    ASSERT_EQ(bench.out("Actual Angle 1"), other.out("Actual Angle 1")) << i;
  }
}

}  // namespace
}  // namespace visum::test
