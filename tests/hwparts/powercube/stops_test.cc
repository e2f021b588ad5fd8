// Everything that stops a module: limits, following error, supply and other faults, and the way back from
// them.
#include "hwparts/fault_set.h"
#include "tests/hwparts/powercube/bus_bench.h"

namespace visum::test {
namespace {

TEST(PowerCube, ATargetBeyondASoftLimitStopsThereWithBeyondSoft) {
  BusBench bench;
  bench.ramp(1, 3.13f);
  ASSERT_TRUE(bench.wait_for(1, bit::kBeyondSoft | bit::kError, 12.0));
  EXPECT_NEAR(bench.position(1), 3.093, 2e-3);
  EXPECT_FALSE(bench.ramp(1, 0.0f));
  bench.send(1, {0x00});
  EXPECT_TRUE(bench.ramp(1, 3.0f));
  bench.run(1.5);
  EXPECT_NEAR(bench.position(1), 3.0, 1e-3);
}

TEST(PowerCube, ATargetBeyondASoftLimitMayBeClampedOrRefused) {
  BusBench clamps("modules: {beyond_limits: clamp}", 0.001, 2.1), refuses("modules: {beyond_limits: refuse}");
  EXPECT_TRUE(clamps.ramp(1, 3.13f));
  clamps.run(4.0);
  EXPECT_NEAR(clamps.position(1), 3.093, 2e-3);
  EXPECT_FALSE(clamps.word(1) & bit::kError);
  EXPECT_FALSE(refuses.ramp(1, 3.13f));
  EXPECT_TRUE(refuses.ramp(1, 3.0f));
}

TEST(PowerCube, VelocityRunsIntoTheSoftLimitAndTrips) {
  BusBench bench("", 0.001, 2.1);
  EXPECT_EQ(bench.send(1, with_value({0x0B, 0x07}, 0.4f)), (Message{0x0B, 0x07, 0x64}));
  ASSERT_TRUE(bench.wait_for(1, bit::kBeyondSoft, 5.0));
  EXPECT_NEAR(bench.position(1), 3.093, 2e-3);
}

// ---- beyond a limit already ----

Message move(std::uint8_t mode, float target) {
  return with_value({0x0B, mode}, target);
}
constexpr std::uint8_t kVelocityMode = 0x07, kCurrentMode = 0x08;

TEST(PowerCube, ACurrentThatLeadsFurtherOutOfASoftLimitTripsAtOnce) {
  BusBench bench("", 0.001, 2.1);
  bench.ramp(1, 3.0f);
  bench.run(3.0);
  bench.send(1, move(kCurrentMode, 4.0f));
  ASSERT_TRUE(bench.wait_for(1, bit::kBeyondSoft | bit::kError, 5.0));
  bench.run(1.0);
  bench.send(1, {0x00});
  EXPECT_EQ(bench.word(1) & (bit::kError | bit::kBeyondSoft), bit::kBeyondSoft);
  const float stood = bench.position(1);
  bench.send(1, move(kCurrentMode, 4.0f));
  bench.run(0.5);
  EXPECT_TRUE(bench.word(1) & bit::kError);
  EXPECT_NEAR(bench.position(1), stood, 1e-3);
  bench.send(1, {0x00});
  bench.send(1, move(kCurrentMode, -4.0f));  // the way back
  ASSERT_TRUE(bench.wait_for(1, bit::kMotion, 0.1));
  bench.run(1.0);
  EXPECT_EQ(bench.word(1) & (bit::kError | bit::kBeyondSoft), 0u);
}

// The limit switches do not depend on the zero. So the hard limits hold before homing, too, when no other
// limit does.
TEST(PowerCube, BeyondAHardLimitNothingLeadsFurtherOutBeforeHomingEither) {
  for (const std::uint8_t mode : {kVelocityMode, kCurrentMode}) {
    SCOPED_TRACE(int(mode));
    BusBench bench(kIncrementalModules, 0.001, 2.1);
    bench.send(1, move(kVelocityMode, 0.4f));
    ASSERT_TRUE(bench.wait_for(1, bit::kBeyondHard | bit::kError, 8.0));
    ASSERT_TRUE(bench.wait_for(1, bit::kBrakeActive, 1.0));
    bench.send(1, {0x00});
    bench.run(0.5);
    const float stood = bench.position(1);
    bench.send(1, move(mode, mode == kVelocityMode ? 0.2f : 4.0f));
    bench.run(0.01);
    EXPECT_TRUE(bench.word(1) & bit::kError);
    ASSERT_TRUE(bench.wait_for(1, bit::kBrakeActive, 1.0)) << "the loop is open again";
    EXPECT_NEAR(bench.position(1), stood, 2e-3);
    bench.send(1, {0x00});
    bench.send(1, move(kVelocityMode, -0.2f));
    bench.run(2.0);
    EXPECT_LT(bench.position(1), stood - 0.1f);
    EXPECT_FALSE(bench.word(1) & (bit::kError | bit::kBeyondHard));
  }
}

TEST(PowerCube, FollowingErrorTripsTowError) {
  BusBench bench;
  bench.plants[0].upper = 0.05;
  bench.ramp(1, 1.0f);
  ASSERT_TRUE(bench.wait_for(1, bit::kTowError | bit::kError, 5.0));
  bench.plants[0].upper = 1e9;
  bench.send(1, {0x00});
  bench.run(0.2);
  EXPECT_FALSE(bench.word(1) & (bit::kTowError | bit::kError));
}

TEST(PowerCube, EmergencyStopIsASupplyFaultThatResetClearsOnceItIsBack) {
  BusBench bench("", 0.001, 0.3);
  bench.ramp(1, 1.0f);
  bench.run(0.5);
  ASSERT_EQ(bench.part->set_parameter("Emergency Stop", true), std::nullopt);
  bench.run(0.5);
  constexpr auto kSupply = bit::kPowVoltErr | bit::kPowerFault | bit::kError;
  EXPECT_EQ(bench.word(1) & kSupply, kSupply);
  EXPECT_TRUE(bench.word(1) & bit::kBrakeActive);
  const float stood = bench.position(1);
  bench.send(1, {0x00});
  EXPECT_EQ(bench.word(1) & kSupply, kSupply);
  EXPECT_FALSE(bench.ramp(1, 0.0f));
  ASSERT_EQ(bench.part->set_parameter("Emergency Stop", false), std::nullopt);
  bench.run(0.1);
  EXPECT_EQ(bench.word(1) & kSupply, kSupply);  // only Reset clears
  bench.send(1, {0x00});
  bench.run(0.2);
  EXPECT_EQ(bench.word(1) & ~bit::kCurLimit, bit::kHomeOk | bit::kRampEnd);
  EXPECT_NEAR(bench.position(1), stood, 1e-3);
}

// RESET closes the loop, and the brake takes its time to open. A command that comes meanwhile is carried out
// once the brake is open, and the state word does not show it as finished before it has begun.
class WhileTheBrakeOpens : public testing::Test {
 protected:
  WhileTheBrakeOpens() {
    for (const bool pressed : {true, false}) {
      EXPECT_EQ(bench.part->set_parameter("Emergency Stop", pressed), std::nullopt);
      bench.run(0.5);
    }
    EXPECT_EQ(bench.send(1, {0x00}), Message{0x00});
    EXPECT_TRUE(bench.word(1) & bit::kBrakeActive);
  }
  void expect_motion_for(double seconds) {
    for (double t = 0.0; t < seconds; t += 0.001) {
      ASSERT_EQ(bench.word(1) & (bit::kMotion | bit::kRampEnd), bit::kMotion) << t;
      bench.tick();
    }
  }
  BusBench bench{"", 0.001, 0.3};
};

TEST_F(WhileTheBrakeOpens, HomeIsTaken) {
  EXPECT_EQ(bench.send(1, {0x01}), Message{0x01});
  EXPECT_FALSE(bench.word(1) & bit::kHomeOk);
  expect_motion_for(0.2);
  ASSERT_TRUE(bench.wait_for(1, bit::kHomeOk | bit::kRampEnd, 10.0));
  bench.run(0.5);
  EXPECT_NEAR(bench.plants[0].joint.position, 0.0, 1e-3);
}

TEST_F(WhileTheBrakeOpens, MotionsAreTaken) {
  EXPECT_TRUE(bench.ramp(1, 0.5f));
  expect_motion_for(0.2);
  bench.run(2.0);
  EXPECT_NEAR(bench.position(1), 0.5, 1e-3);
}

TEST_F(WhileTheBrakeOpens, HaltStillStops) {
  EXPECT_TRUE(bench.ramp(1, 0.5f));
  EXPECT_EQ(bench.send(1, {0x02}), Message{0x02});
  bench.run(1.0);
  EXPECT_EQ(bench.word(1) & (bit::kHalted | bit::kMotion), bit::kHalted);
  EXPECT_NEAR(bench.position(1), 0.3, 1e-3);
}

TEST(PowerCube, AFaultOfOneModuleDoesNotStopTheHomingOfTheOthersOnTheBus) {
  BusBench bench("", 0.001, 0.3);
  bench.plants[0].upper = 0.35;
  bench.ramp(1, 1.0f);
  bench.send(2, {0x01});
  bench.run(1.5);
  EXPECT_TRUE(bench.word(1) & bit::kTowError);
  ASSERT_TRUE(bench.wait_for(2, bit::kHomeOk | bit::kRampEnd, 3.0));
  EXPECT_NEAR(bench.position(2), 0.0, 1e-3);
}

// The module cannot know the way that its gear has lost. Only its reference switch tells.
TEST(PowerCube, ResetDoesNotRepairAGearThatHasSlipped) {
  BusBench bench;
  std::string why;
  const auto slips = hwparts::make_fault("gear_slip", {{"joint", 1}, {"effort", 8.0}}, why);
  ASSERT_TRUE(slips) << why;
  const std::array active{hwparts::ActiveFault{0, *slips, 0}};
  bench.plants[0].upper = 0.2;
  bench.part->set_faults(active);
  bench.ramp(1, 0.5f);
  bench.run(4.0);
  bench.part->set_faults({});
  bench.plants[0].upper = 1e9;
  bench.run(0.5);
  const double lost = bench.position(1) - bench.plants[0].joint.position;
  EXPECT_GT(lost, 0.2);
  bench.send(1, {0x00});
  bench.run(0.1);
  EXPECT_NEAR(bench.position(1) - bench.plants[0].joint.position, lost, 2e-3);
  EXPECT_TRUE(bench.set(1, 0x59, 0.1f));  // a home offset acts as ever, once
  for (int times = 0; times < 2; ++times) bench.send(1, {0x00});
  bench.run(0.1);
  EXPECT_NEAR(bench.position(1) - bench.plants[0].joint.position, lost + 0.1, 2e-3);
  bench.send(1, {0x01});
  ASSERT_TRUE(bench.wait_for(1, bit::kHomeOk | bit::kRampEnd, 10.0));
  bench.run(0.5);
  EXPECT_NEAR(bench.position(1) - bench.plants[0].joint.position, 0.1, 2e-3);
}

}  // namespace
}  // namespace visum::test
