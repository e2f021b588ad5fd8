// The behaviour that clients of real modules rely on: homing, halt, reset, watchdog, bus settings. Limits and
// faults are in stops_test.cc.
#include "tests/hwparts/powercube/bus_bench.h"

namespace visum::test {
namespace {

TEST(PowerCube, IncrementalModulesComeUpNotHomedAndAbsoluteOnesHomed) {
  BusBench incremental(kIncrementalModules), absolute("homed: false, modules: {firmware: 0x4634}"), arm;
  EXPECT_EQ(incremental.word(1), bit::kRampEnd);
  EXPECT_EQ(incremental.get<std::uint16_t>(1, 0x1D), 0x3521);
  EXPECT_EQ(incremental.get<std::uint32_t>(1, 0x58), 0x249u);
  EXPECT_EQ(absolute.word(1), bit::kRampEnd | bit::kHomeOk);
  EXPECT_EQ(absolute.get<std::uint16_t>(1, 0x1D), 0x4634);
  EXPECT_EQ(absolute.get<std::uint32_t>(1, 0x58), 0x24Cu);
  EXPECT_EQ(arm.word(8), bit::kRampEnd | bit::kHomeOk);
}

TEST(PowerCube, ModulesMayDifferFromEachOther) {
  BusBench bench("homed: false, modules: {each: {2: {firmware: 0x4634, serial_number: 41261}}}");
  EXPECT_EQ(bench.get<std::uint16_t>(1, 0x1D), 0x3521);
  EXPECT_EQ(bench.get<std::uint16_t>(2, 0x1D), 0x4634);
  EXPECT_EQ(bench.get<std::uint32_t>(2, 0x1A), 41261u);
  EXPECT_TRUE(bench.word(2) & bit::kHomeOk);
  EXPECT_FALSE(bench.word(1) & bit::kHomeOk);
}

TEST(PowerCube, OnlyTheModulesThatAreThereAnswer) {
  BusBench bench;
  int found = 0;
  for (int id = 1; id <= 31; ++id) found += bench.send(id, {0x0A, 0x1D}) ? 1 : 0;
  EXPECT_EQ(found, 8);
}

// Homing is acknowledged at once and clears HOME_OK at once. It moves with the homing speed, and sets HOME_OK
// and RAMP_END at its end.
TEST(PowerCube, HomingIsAMotionThatFindsTheZero) {
  BusBench bench(kIncrementalModules, 0.001, 0.5);
  bench.run(0.1);
  EXPECT_NEAR(bench.position(1), 0.0, 1e-4);  // counts from where it was switched on
  EXPECT_EQ(bench.send(1, {0x01}), Message{0x01});
  EXPECT_FALSE(bench.word(1) & (bit::kHomeOk | bit::kRampEnd));
  bench.run(1.0);
  EXPECT_TRUE(bench.word(1) & bit::kMotion);
  EXPECT_NEAR(bench.get<float>(1, 0x41), -0.2, 0.01);
  ASSERT_TRUE(bench.wait_for(1, bit::kHomeOk | bit::kRampEnd, 10.0));
  bench.run(0.5);
  EXPECT_NEAR(bench.position(1), 0.0, 1e-3);
  EXPECT_NEAR(bench.plants[0].joint.position, 0.0, 1e-3);
  EXPECT_NEAR(bench.out("Actual Angle 1"), bench.position(1), 1e-6);
  EXPECT_EQ(bench.word(2) & bit::kHomeOk, 0u);  // only module 1 was told to
  EXPECT_NEAR(bench.plants[1].joint.position, 0.5, 1e-3);
}

TEST(PowerCube, HomingWorksWhileHalted) {
  BusBench bench(kIncrementalModules, 0.001, 0.1);
  bench.send(1, {0x02});
  bench.run(0.05);
  bench.send(1, {0x01});
  ASSERT_TRUE(bench.wait_for(1, bit::kHomeOk, 10.0));
  EXPECT_TRUE(bench.word(1) & bit::kHalted);
  bench.run(0.5);
  bench.send(1, {0x00});
  EXPECT_EQ(bench.word(1), bit::kHomeOk | bit::kRampEnd);
}

TEST(PowerCube, ZeroMoveAfterHomingGoesOnToZero) {
  BusBench bench("homed: false, modules: {config: 0x02000108}", 0.001, 0.01);
  bench.send(8, {0x01});  // the gripper's home is at 0.034
  ASSERT_TRUE(bench.wait_for(8, bit::kHomeOk | bit::kRampEnd, 20.0));
  EXPECT_NEAR(bench.position(8), 0.0, 3e-4);
}

TEST(PowerCube, TheSequenceOfEveryClientWorks) {
  BusBench bench(kIncrementalModules);
  for (int id = 1; id <= 8; ++id) {
    EXPECT_EQ(bench.send(id, {0x00}), Message{0x00});
    bench.send(id, {0x01});
  }
  for (int id = 1; id <= 8; ++id) ASSERT_TRUE(bench.wait_for(id, bit::kHomeOk | bit::kRampEnd, 20.0)) << id;
  for (int id = 1; id <= 7; ++id) {
    EXPECT_EQ(bench.send(id, {0x00}), Message{0x00});
    EXPECT_TRUE(bench.set(id, 0x45, -2.0f) && bench.set(id, 0x46, 2.0f) && bench.set(id, 0x48, 0.3f) &&
                bench.set(id, 0x4A, 1.0f) && bench.set(id, 0x4C, 3.0f));
    EXPECT_TRUE(bench.ramp(id, 0.25f));
  }
  bench.run(3.0);
  for (int id = 1; id <= 7; ++id) {
    EXPECT_EQ(bench.word(id) & ~bit::kCurLimit, bit::kHomeOk | bit::kRampEnd) << id;
    EXPECT_NEAR(bench.position(id), 0.25, 1e-3) << id;
    EXPECT_NEAR(bench.out("Actual Angle " + std::to_string(id)), 0.25, 1e-3);
  }
}

TEST(PowerCube, HaltBrakesAndOnlyResetEndsIt) {
  BusBench bench;
  bench.ramp(1, 2.0f);
  bench.run(1.0);
  EXPECT_EQ(bench.send(1, {0x02}), Message{0x02});
  EXPECT_TRUE(bench.word(1) & bit::kHalted);
  bench.run(1.0);
  const float stood = bench.position(1);
  EXPECT_LT(stood, 0.5f);
  EXPECT_FALSE(bench.ramp(1, 1.0f));  // refused
  bench.run(0.5);
  EXPECT_EQ(bench.position(1), stood);
  bench.send(1, {0x00});
  bench.run(0.5);
  EXPECT_NEAR(bench.position(1), stood, 1e-5);  // the old ramp is gone
  EXPECT_TRUE(bench.ramp(1, 0.0f));
  bench.run(3.0);
  EXPECT_NEAR(bench.position(1), 0.0, 1e-3);
}

TEST(PowerCube, BroadcastHaltAndResetReachAll) {
  BusBench bench;
  for (const Message& halt : {Message{0x02, 0x00}, Message{0x02}}) {  // m5api's two bytes, KTH's one
    bench.broadcast(halt);
    for (int id = 1; id <= 8; ++id) EXPECT_TRUE(bench.word(id) & bit::kHalted) << id;
    bench.broadcast({0x00, 0x00});
    for (int id = 1; id <= 8; ++id) EXPECT_FALSE(bench.word(id) & bit::kHalted) << id;
  }
}

TEST(PowerCube, DisableOnHaltOpensTheLoopAndTheBrakeFalls) {
  BusBench bench("modules: {config: 0x00800108}");
  bench.send(2, {0x02});
  ASSERT_TRUE(bench.wait_for(2, bit::kBrakeActive, 1.0));
  bench.send(2, {0x00});
  bench.run(0.2);
  EXPECT_EQ(bench.word(2), bit::kHomeOk | bit::kRampEnd);
}

TEST(PowerCube, WatchdogIsArmedByTheFirstLifeSignAndStopsWhenItEnds) {
  BusBench bench("modules: {watchdog_s: 0.05}");
  bench.broadcast({0x07, 0x00});
  bench.run(0.2);
  EXPECT_FALSE(bench.word(1) & bit::kCommError);  // not enabled
  EXPECT_TRUE(bench.set<std::uint32_t>(1, 0x39, 0x01000108));
  bench.run(0.2);
  EXPECT_FALSE(bench.word(1) & bit::kCommError);  // not armed
  bench.ramp(1, 1.0f);
  for (int i = 0; i < 10; ++i) {
    bench.broadcast({0x07});
    bench.run(0.04);
  }
  EXPECT_FALSE(bench.word(1) & bit::kCommError);
  bench.run(0.02);
  EXPECT_TRUE(bench.word(1) & bit::kCommError);
  EXPECT_TRUE(bench.word(1) & bit::kError);
  bench.run(1.0);
  EXPECT_FALSE(bench.word(1) & bit::kMotion);
  bench.send(1, {0x00});
  bench.run(0.2);
  EXPECT_EQ(bench.word(1) & (bit::kError | bit::kCommError), 0u);
}

TEST(PowerCube, WithoutAHostTheMotionGoesOn) {
  BusBench bench;
  bench.ramp(1, 0.3f);
  bench.part->modules()->connect(false);
  bench.run(3.0);
  EXPECT_EQ(bench.send(1, {0x0A, 0x3C}), std::nullopt);  // cut
  bench.part->modules()->connect(true);
  EXPECT_NEAR(bench.position(1), 0.3, 1e-3);
}

TEST(PowerCube, HomeOffsetIsSeenAfterReset) {
  BusBench bench;
  bench.run(0.1);
  EXPECT_TRUE(bench.set(1, 0x59, 0.1f));
  EXPECT_NEAR(bench.position(1), 0.0, 1e-4);
  bench.send(1, {0x00});
  EXPECT_NEAR(bench.position(1), 0.1, 1e-4);
  bench.run(0.5);
  EXPECT_NEAR(bench.plants[0].joint.position, 0.0, 1e-4);  // nothing moved
  EXPECT_NEAR(bench.out("Actual Angle 1"), 0.1, 1e-4);     // and the ports say the same
  bench.ramp(1, 0.3f);
  bench.run(2.0);
  EXPECT_NEAR(bench.plants[0].joint.position, 0.2, 1e-3);
}

TEST(PowerCube, ResetKeepsHomeOkPositionAndParametersButNotTargets) {
  BusBench bench;
  bench.ramp(1, 0.2f);
  bench.run(2.0);
  bench.set(1, 0x48, 0.3f);
  bench.set(1, 0x4F, 0.1f);
  bench.send(1, {0x00});
  EXPECT_TRUE(bench.word(1) & bit::kHomeOk);
  EXPECT_NEAR(bench.position(1), 0.2, 1e-3);
  EXPECT_FLOAT_EQ(bench.get<float>(1, 0x48), 0.3f);
  EXPECT_FLOAT_EQ(bench.get<float>(1, 0x4F), 0.3f);
}

TEST(PowerCube, SavePositionLatchesAllModulesAtOnce) {
  BusBench bench;
  for (int id = 1; id <= 7; ++id) bench.ramp(id, 0.5f);
  bench.run(0.7);
  std::array<float, 7> at{};
  for (int id = 1; id <= 7; ++id) at[static_cast<std::size_t>(id) - 1] = bench.position(id);
  bench.broadcast({0x0E, 0x00});
  bench.run(0.5);
  for (int id = 1; id <= 7; ++id) {
    EXPECT_EQ(bench.get<float>(id, 0x63), at[static_cast<std::size_t>(id) - 1]);
    EXPECT_NE(bench.position(id), bench.get<float>(id, 0x63));
  }
}

TEST(PowerCube, SynchronousMotionWaitsForTheStartOnCanOnly) {
  BusBench bench;
  EXPECT_TRUE(bench.set<std::uint32_t>(1, 0x39, 0x08000108));
  EXPECT_TRUE(bench.send(1, with_value({0x0B, 0x04}, 0.2f), BusFraming::kCan));
  bench.run(0.5);
  EXPECT_NEAR(bench.position(1), 0.0, 1e-4);
  bench.broadcast({0x0F, 0x00}, BusFraming::kCan);
  EXPECT_TRUE(bench.word(1) & bit::kMotion);
  bench.run(2.0);
  EXPECT_NEAR(bench.position(1), 0.2, 1e-3);
  bench.ramp(1, 0.0f);  // serial: at once
  EXPECT_TRUE(bench.word(1) & bit::kMotion);
}

TEST(PowerCube, DisabledAcknowledgesAreMissingOnCanButGetIsAnswered) {
  BusBench bench;
  EXPECT_TRUE(bench.set<std::uint32_t>(1, 0x39, 0x04000108));
  EXPECT_EQ(bench.send(1, {0x02}, BusFraming::kCan), std::nullopt);
  EXPECT_TRUE(bench.word(1) & bit::kHalted);
  EXPECT_TRUE(bench.send(1, {0x0A, 0x27}, BusFraming::kCan));
  EXPECT_EQ(bench.send(1, {0x00}, BusFraming::kSerial), Message{0x00});
}

TEST(PowerCube, OnCanTheIdAndTheCommandMustAgree) {
  BusBench bench;
  auto& bus = *bench.part->modules();
  EXPECT_FALSE(bus.handle({Telegram::Kind::kSet, 1, {0x0A, 0x1D}}, BusFraming::kCan));
  EXPECT_FALSE(bus.handle({Telegram::Kind::kGet, 1, {0x02}}, BusFraming::kCan));
  EXPECT_FALSE(bench.word(1) & bit::kHalted);
  EXPECT_FALSE(bus.handle({Telegram::Kind::kAnswer, 1, {0x0A, 0x1D}}, BusFraming::kCan));
}

TEST(PowerCube, StateFramesComeWithEveryChangeWhereSyncTransmitIsOn) {
  BusBench bench("modules: {state_period_s: 10}");
  bench.tick();
  EXPECT_TRUE(bench.part->modules()->spontaneous().empty());
  EXPECT_TRUE(bench.set<std::uint32_t>(3, 0x39, 0x10000108));
  bench.tick();
  const auto first = bench.part->modules()->spontaneous();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].kind, Telegram::Kind::kState);
  EXPECT_EQ(first[0].module, 3);
  EXPECT_EQ(powercube::value_at<std::uint32_t>(first[0].message, 0), bit::kHomeOk | bit::kRampEnd);
  bench.tick();
  EXPECT_TRUE(bench.part->modules()->spontaneous().empty());
  bench.send(3, {0x02});
  bench.tick();
  EXPECT_EQ(bench.part->modules()->spontaneous().size(), 1u);
}

TEST(PowerCube, M3CompatibleModulesDoNotMoveBeforeTheyAreHomed) {
  BusBench strict("homed: false, modules: {config: 0x00100108}"), free(kIncrementalModules);
  EXPECT_FALSE(strict.ramp(1, 0.1f));
  EXPECT_TRUE(free.ramp(1, 0.1f));
  free.run(2.0);
  EXPECT_NEAR(free.position(1), 0.1, 1e-3);
}

TEST(PowerCube, RefusalsMayBeSilent) {
  BusBench loud, silent("modules: {refused: silence}"), odd("modules: {refused_byte: 0x15}");
  for (auto* bench : {&loud, &silent, &odd}) bench->send(1, {0x02});
  const auto ramp = with_value({0x0B, 0x04}, 0.1f);
  EXPECT_EQ(loud.send(1, ramp), (Message{0x0B, 0x04, 0x00}));
  EXPECT_EQ(silent.send(1, ramp), std::nullopt);
  EXPECT_EQ(odd.send(1, ramp), (Message{0x0B, 0x04, 0x15}));
}

TEST(PowerCube, BroadcastsOnRs232MayBeIgnored) {
  BusBench deaf("modules: {rs232_broadcasts: false}");
  deaf.broadcast({0x02});
  EXPECT_FALSE(deaf.word(1) & bit::kHalted);
  deaf.broadcast({0x02}, BusFraming::kCan);
  EXPECT_TRUE(deaf.word(1) & bit::kHalted);
}

TEST(PowerCube, AnotherAddressIsAnsweredAtOnce) {
  BusBench bench;
  EXPECT_TRUE(bench.set<std::uint8_t>(7, 0x20, 12));
  EXPECT_EQ(bench.send(7, {0x0A, 0x1D}), std::nullopt);
  EXPECT_EQ(bench.get<std::uint8_t>(12, 0x20), 12);
}

}  // namespace
}  // namespace visum::test
