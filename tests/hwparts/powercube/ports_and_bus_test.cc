// Ports and field bus command the same drive: the last command moves it, and both can stop it.
#include "tests/hwparts/powercube/bus_bench.h"

namespace visum::test {
namespace {

TEST(PowerCube, WhoSpokeLastMovesTheDrive) {
  BusBench bench;
  bench.in("Desired Angle 1") = 0.3;
  bench.run(2.0);
  EXPECT_NEAR(bench.position(1), 0.3, 1e-3);
  bench.ramp(1, 0.1f);
  bench.run(2.0);
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.1, 1e-3);  // the old port value moves nothing
  bench.in("Desired Angle 1") = 0.2;
  bench.run(2.0);
  EXPECT_NEAR(bench.position(1), 0.2, 1e-3);
}

TEST(PowerCube, WhoSpokeLastMovesTheDriveBetweenTwoTicksToo) {
  for (const bool bus_last : {true, false}) {
    BusBench bench;
    bench.tick();
    if (!bus_last) bench.ramp(1, 0.1f);
    bench.in("Desired Angle 1") = 0.3;
    bench.part->latch(bench.inputs);
    if (bus_last) bench.ramp(1, 0.1f);
    bench.run(2.0);
    EXPECT_NEAR(bench.position(1), bus_last ? 0.1 : 0.3, 1e-3);
  }
}

TEST(PowerCube, AFaultOfOneModuleDoesNotStopTheOthersOnTheBus) {
  BusBench bench;
  bench.plants[0].upper = 0.05;
  bench.ramp(1, 1.0f);
  bench.ramp(2, 0.4f);
  bench.run(3.0);
  EXPECT_TRUE(bench.word(1) & bit::kTowError);
  EXPECT_NEAR(bench.position(2), 0.4, 1e-3);
}

TEST(PowerCube, ExecutionEnableStopsTheBusToo) {
  BusBench bench;
  bench.ramp(1, 1.0f);
  bench.run(0.5);
  bench.in("Execution Enable") = 0.0;
  bench.run(1.0);
  EXPECT_LT(bench.position(1), 0.4f);
  EXPECT_FALSE(bench.word(1) & bit::kMotion);
}

TEST(PowerCube, WithoutExecutionEnableNothingIsTakenThatWouldBeginLater) {
  for (const bool from_the_start : {true, false}) {
    BusBench bench(from_the_start ? "execution_enable: false" : "", 0.001, 0.3);
    if (!from_the_start) bench.in("Execution Enable") = 0.0, bench.tick();
    EXPECT_EQ(bench.send(1, {0x01}), Message{0x01});
    EXPECT_TRUE(bench.word(1) & bit::kHomeOk);
    EXPECT_FALSE(bench.ramp(1, 0.5f));
    bench.run(0.2);
    EXPECT_FALSE(bench.word(1) & bit::kMotion);
    bench.in("Execution Enable") = 1.0;
    bench.run(1.0);
    EXPECT_NEAR(bench.position(1), 0.3, 1e-3);
    EXPECT_TRUE(bench.ramp(1, 0.5f));
    bench.run(2.0);
    EXPECT_NEAR(bench.position(1), 0.5, 1e-3);
  }
}

TEST(PowerCube, ExecutionEnableIsThatOfTheStateThatIsTakenBack) {
  BusBench bench;
  bench.in("Execution Enable") = 0.0;
  bench.tick();
  const auto disabled = bench.save();
  bench.in("Execution Enable") = 1.0;
  bench.tick();
  EXPECT_TRUE(bench.ramp(1, 0.1f));
  bench.load(disabled);
  EXPECT_FALSE(bench.ramp(1, 0.1f));
  bench.part->reset();
  EXPECT_TRUE(bench.ramp(1, 0.1f));
}

// A motion that waits for START is dropped when the ports stop the drives: a later START does not begin it.
TEST(PowerCube, WhatThePortsStopWaitsForNoStart) {
  const std::vector<std::string> stops[] = {{"Halt", "Reset"}, {"Reset"}, {"Home"}};
  for (const auto& counters : stops) {
    SCOPED_TRACE(counters.front());
    BusBench bench;
    EXPECT_TRUE(bench.set<std::uint32_t>(1, 0x39, 0x08000108));
    EXPECT_TRUE(bench.send(1, with_value({0x0B, 0x04}, 0.2f), BusFraming::kCan));
    for (const auto& counter : counters) bench.bump(counter), bench.run(0.5);
    bench.broadcast({0x0F, 0x00}, BusFraming::kCan);
    EXPECT_FALSE(bench.word(1) & bit::kMotion);
    bench.run(0.5);
    EXPECT_NEAR(bench.position(1), 0.0, 1e-3);
  }
}

TEST(PowerCube, PortsAndBusShowTheSameStateWord) {
  BusBench bench;
  bench.ramp(1, 0.5f);
  bench.run(0.5);
  for (int id = 1; id <= 8; ++id) EXPECT_EQ(bench.module(id == 8 ? 9 : id), bench.word(id)) << id;
}

}  // namespace
}  // namespace visum::test
