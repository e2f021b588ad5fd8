// Motion commands over the bus: each mode in its float, increment and extended form, and steps with their
// queue.
#include <cmath>

#include "tests/hwparts/powercube/bus_bench.h"

namespace visum::test {
namespace {

struct Form {
  const char* name;
  std::uint8_t mode;
  bool increments, extended;
};

class Ramps : public testing::TestWithParam<Form> {};

TEST_P(Ramps, ReachTheTarget) {
  const auto form = GetParam();
  BusBench bench;
  const float per_unit = bench.get<float>(2, 0x3B);
  const auto request =
      form.increments ? with_value({0x0B, form.mode}, static_cast<std::int32_t>(std::lround(0.4f * per_unit)))
                      : with_value({0x0B, form.mode}, 0.4f);
  const auto answer = bench.send(2, request);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->size, form.extended ? 8 : 3);
  if (form.extended) {
    EXPECT_EQ(answer->data[6], 0x10);  // MOTION, nothing else
  }
  EXPECT_EQ(bench.get<std::uint8_t>(2, 0x3A), form.mode);
  bench.run(3.0);
  EXPECT_NEAR(bench.position(2), 0.4, 1e-3);
  EXPECT_NEAR(bench.get<float>(2, 0x4E), 0.4, 1e-5);
}
INSTANTIATE_TEST_SUITE_P(Modes, Ramps,
                         testing::Values(Form{"Float", 0x04, false, false},
                                         Form{"FloatExtended", 0x0E, false, true},
                                         Form{"Increments", 0x09, true, false},
                                         Form{"IncrementsExtended", 0x13, true, true}),
                         [](const auto& info) { return std::string(info.param.name); });

class Velocities : public testing::TestWithParam<Form> {};

TEST_P(Velocities, RunUntilAnotherCommand) {
  const auto form = GetParam();
  BusBench bench;
  const float per_unit = bench.get<float>(2, 0x3B);
  const auto run = [&](float speed) {
    const auto request =
        form.increments
            ? with_value({0x0B, form.mode}, static_cast<std::int32_t>(std::lround(speed * per_unit)))
            : with_value({0x0B, form.mode}, speed);
    return bench.send(2, request);
  };
  ASSERT_EQ(run(-0.2f)->size, form.extended ? 8 : 3);
  bench.run(1.0);
  EXPECT_NEAR(bench.get<float>(2, 0x41), -0.2, 0.01);
  EXPECT_TRUE(bench.word(2) & bit::kRampSteady);
  run(0.0f);
  bench.run(1.0);
  EXPECT_EQ(bench.word(2) & (bit::kMotion | bit::kRampEnd), bit::kRampEnd);
}
INSTANTIATE_TEST_SUITE_P(Modes, Velocities,
                         testing::Values(Form{"Float", 0x07, false, false},
                                         Form{"FloatExtended", 0x11, false, true},
                                         Form{"Increments", 0x0C, true, false},
                                         Form{"IncrementsExtended", 0x16, true, true}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(PowerCubeMotion, TargetSpeedAndAccelerationShapeTheRamp) {
  BusBench bench;
  EXPECT_TRUE(bench.set(1, 0x4F, 0.1f) && bench.set(1, 0x50, 0.5f));
  bench.ramp(1, 0.4f);
  double fastest = 0.0;
  int ticks = 0;
  while (bench.word(1) & bit::kMotion && ++ticks < 10'000) {
    bench.tick();
    fastest = std::max(fastest, static_cast<double>(bench.get<float>(1, 0x42)));
  }
  EXPECT_NEAR(fastest, 0.1, 1e-6);
  EXPECT_NEAR(ticks * 1e-3, 0.4 / 0.1 + 0.1 / 0.5, 0.01);
}

TEST(PowerCubeMotion, SpeedsAboveTheMaximumAreBroughtDownToIt) {
  BusBench bench, strict("modules: {above_maximum: refuse}");
  EXPECT_TRUE(bench.set(1, 0x48, 5.0f));
  EXPECT_FLOAT_EQ(bench.get<float>(1, 0x48), 0.438f);
  EXPECT_TRUE(bench.set(1, 0x48, 0.2f));
  EXPECT_TRUE(bench.set(1, 0x4F, 0.4f));
  EXPECT_FLOAT_EQ(bench.get<float>(1, 0x4F), 0.2f);
  EXPECT_FALSE(strict.set(1, 0x48, 5.0f));
  EXPECT_TRUE(strict.set(1, 0x48, 0.438f));  // the maximum itself, as it was read
}

TEST(PowerCubeMotion, AStepByItselfArrivesAtRestWhenItIsDue) {
  BusBench bench;
  bench.send(1, BusBench::step(0x06, 0.2f, 1000));
  EXPECT_TRUE(bench.word(1) & bit::kInProgress);
  bench.run(0.5);
  EXPECT_NEAR(bench.get<float>(1, 0x3E), 0.1, 2e-3);
  bench.run(0.499);
  EXPECT_TRUE(bench.word(1) & bit::kInProgress);
  bench.run(0.003);
  EXPECT_FALSE(bench.word(1) & bit::kInProgress);
  EXPECT_FLOAT_EQ(bench.get<float>(1, 0x3E), 0.2f);
  EXPECT_EQ(bench.get<float>(1, 0x42), 0.0f);
}

TEST(PowerCubeMotion, AStepThatAsksTooMuchIsAsFastAsTheLimitsAllow) {
  for (const std::uint16_t ms : {0, 1, 100}) {
    BusBench bench;
    bench.send(1, BusBench::step(0x10, 0.5f, ms));
    double fastest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      bench.tick();
      fastest = std::max(fastest, static_cast<double>(bench.get<float>(1, 0x42)));
    }
    EXPECT_NEAR(fastest, 0.438, 1e-6);
    EXPECT_NEAR(bench.position(1), 0.5, 1e-3);
    EXPECT_FALSE(bench.word(1) & bit::kError);
  }
}

TEST(PowerCubeMotion, ASecondStepWaitsAndAThirdCutsTheFirstShort) {
  BusBench bench;
  bench.send(1, BusBench::step(0x06, 0.05f, 500));
  EXPECT_EQ(bench.word(1) & (bit::kInProgress | bit::kFullBuffer), bit::kInProgress);
  bench.send(1, BusBench::step(0x06, 0.3f, 500));
  EXPECT_TRUE(bench.word(1) & bit::kFullBuffer);
  bench.send(1, BusBench::step(0x06, 0.1f, 500));
  EXPECT_TRUE(bench.word(1) & bit::kFullBuffer);
  bench.run(0.501);
  EXPECT_EQ(bench.word(1) & (bit::kInProgress | bit::kFullBuffer), bit::kInProgress);
  bench.run(1.5);
  EXPECT_NEAR(bench.position(1), 0.1, 1e-3);
  EXPECT_FALSE(bench.word(1) & bit::kInProgress);
}

TEST(PowerCubeMotion, AThirdStepMayReplaceTheSecondOrBeRefused) {
  BusBench replaces("modules: {third_step: replace}");
  for (const float target : {0.05f, 0.3f, 0.1f}) replaces.send(1, BusBench::step(0x06, target, 500));
  replaces.run(0.4);
  EXPECT_LT(replaces.position(1), 0.06f);
  replaces.run(1.5);
  EXPECT_NEAR(replaces.position(1), 0.1, 1e-3);

  BusBench strict("modules: {third_step: refuse}");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(strict.send(1, BusBench::step(0x06, 0.1f, 500))->data[2], 0x64);
  EXPECT_EQ(strict.send(1, BusBench::step(0x06, 0.1f, 500))->data[2], 0x00);
}

// A client streams a sine in steps every 20 ms, each a little longer than that, as KTH's client does.
TEST(PowerCubeMotion, StreamedStepsFollowThePathWithoutStopping) {
  BusBench bench;
  const auto path = [](double t) { return 0.15 * (1.0 - std::cos(1.2 * t)); };
  double worst = 0.0, slowest = 1.0;
  for (int k = 0; k < 150; ++k) {
    const double t = k * 0.02;
    bench.send(3, BusBench::step(0x10, static_cast<float>(path(t + 0.02)), 22));
    for (int i = 0; i < 20; ++i) {
      bench.tick();
      const double now = t + i * 1e-3;
      worst = std::max(worst, std::abs(bench.get<float>(3, 0x3E) - path(now - 0.02)));
      if (now > 1.0 && now < 1.6) slowest = std::min(slowest, static_cast<double>(bench.get<float>(3, 0x42)));
    }
  }
  EXPECT_LT(worst, 0.01);    // the lag is no longer than the queue
  EXPECT_GT(slowest, 0.12);  // the path's speed there is 0.17
  EXPECT_FALSE(bench.word(3) & bit::kError);
}

// Module 1's soft limit is at 3.093.
double peak_of(BusBench& bench, double seconds) {
  double most = -1e9;
  for (double t = 0.0; t < seconds; t += 0.001) {
    bench.tick();
    most = std::max(most, static_cast<double>(bench.get<float>(1, 0x3E)));
  }
  return most;
}

TEST(PowerCubeMotion, AStepLongAfterTheLastOneIsAStepByItself) {
  BusBench bench("", 0.001, 2.2);
  bench.send(1, BusBench::step(0x06, 2.2f, 100));
  bench.run(1.0);
  bench.send(1, BusBench::step(0x06, 3.09f, 4000));
  EXPECT_LT(peak_of(bench, 5.0), 3.09 + 1e-4);
  EXPECT_NEAR(bench.position(1), 3.09, 1e-3);
  EXPECT_FALSE(bench.word(1) & bit::kError);
}

TEST(PowerCubeMotion, ALongStepThatJoinsComesToRestAtItsEnd) {
  for (const bool queued : {true, false}) {
    BusBench bench("", 0.001, 2.2);
    bench.send(1, BusBench::step(0x06, 2.4f, 1000));
    if (!queued) bench.run(1.01);
    bench.send(1, BusBench::step(0x06, 3.09f, 3000));
    if (queued) bench.run(1.001);
    bench.run(1.5);
    EXPECT_GT(bench.get<float>(1, 0x42), 0.2);
    EXPECT_LT(peak_of(bench, 3.0), 3.09 + 1e-4) << queued;
    EXPECT_FALSE(bench.word(1) & (bit::kError | bit::kInProgress)) << queued;
    EXPECT_NEAR(bench.position(1), 3.09, 1e-3) << queued;
  }
}

TEST(PowerCubeMotion, AStreamThatEndsAtSpeedStopsBeforeTheSoftLimit) {
  BusBench bench("", 0.001, 2.2);
  float target = 2.2f;
  double most = 0.0, fastest = 0.0;
  while (target < 3.07f) {
    target += 0.008f;  // 0.4 rad/s
    bench.send(1, BusBench::step(0x10, target, 22));
    most = std::max(most, peak_of(bench, 0.02));
    fastest = std::max(fastest, static_cast<double>(bench.get<float>(1, 0x42)));
  }
  EXPECT_GT(fastest, 0.39);
  most = std::max(most, peak_of(bench, 2.0));
  EXPECT_GT(most, target);
  EXPECT_LE(most, 3.093);
  EXPECT_FALSE(bench.word(1) & bit::kError);
  EXPECT_NEAR(bench.position(1), target, 1e-3);
}

TEST(PowerCubeMotion, ATargetSpeedOfZeroIsNoMotion) {
  for (const std::uint8_t parameter : {0x4F, 0x29}) {
    BusBench bench;
    EXPECT_TRUE(parameter == 0x4F ? bench.set(1, parameter, 0.0f) : bench.set<std::int32_t>(1, parameter, 0));
    EXPECT_EQ(bench.get<float>(1, 0x4F), 0.0f);
    EXPECT_TRUE(bench.ramp(1, 0.3f));
    bench.run(1.0);
    EXPECT_NEAR(bench.position(1), 0.0, 1e-3);
    EXPECT_EQ(bench.word(1), bit::kHomeOk | bit::kRampEnd);
    EXPECT_TRUE(bench.set(1, 0x4F, 0.2f) && bench.ramp(1, 0.3f));
    bench.run(2.5);
    EXPECT_NEAR(bench.position(1), 0.3, 1e-3);
    EXPECT_FALSE(bench.set(1, 0x50, 0.0f)) << "that is another matter: it could not even stop";
  }
}

TEST(PowerCubeMotion, CurrentGripsAndShowsWhenItStands) {
  BusBench bench;
  bench.plants[7].lower = bench.plants[8].lower = 0.010;  // an object of 20 mm between the fingers
  EXPECT_EQ(bench.send(8, with_value({0x0B, 0x08}, -1.0f)), (Message{0x0B, 0x08, 0x64}));
  EXPECT_TRUE(bench.word(8) & bit::kMotion);
  ASSERT_TRUE(bench.wait_for(8, bit::kRampEnd, 5.0));
  EXPECT_NEAR(bench.position(8), 0.020, 1e-3);
  EXPECT_NEAR(bench.get<float>(8, 0x4D), -1.0, 1e-3);
  EXPECT_FALSE(bench.word(8) & bit::kError);
  bench.send(8, with_value({0x0B, 0x08}, 1.0f));  // positive opens
  bench.run(0.1);
  EXPECT_GT(bench.position(8), 0.022f);
  bench.ramp(8, 0.03f);  // and back under position control
  bench.run(2.0);
  EXPECT_NEAR(bench.position(8), 0.03, 1e-3);
}

TEST(PowerCubeMotion, CurrentIsLimitedToNominalUnlessAllOfItIsAllowed) {
  BusBench bench;
  bench.plants[0].lower = bench.plants[0].upper = 0.0;
  bench.send(1, with_value({0x0B, 0x08}, 20.0f));
  bench.run(0.1);
  EXPECT_NEAR(bench.get<float>(1, 0x4D), 5.7, 1e-3);
  EXPECT_TRUE(bench.word(1) & bit::kCurLimit);
  bench.send(1, {0x00});
  EXPECT_FALSE(bench.word(1) & bit::kCurLimit);
  EXPECT_TRUE(bench.set<std::uint32_t>(1, 0x39, 0x00080108));
  bench.send(1, with_value({0x0B, 0x08}, 20.0f));
  bench.run(0.1);
  EXPECT_NEAR(bench.get<float>(1, 0x4D), 9.5, 1e-3);
}

TEST(PowerCubeMotion, CurrentInDigitsComesWithSixteenBitsOrThirtyTwo) {
  BusBench bench;
  bench.plants[0].lower = bench.plants[0].upper = 0.0;
  bench.send(1, with_value({0x0B, 0x0D}, static_cast<std::int16_t>(-100)));
  bench.run(0.05);
  EXPECT_NEAR(bench.get<float>(1, 0x4D), -1.9, 1e-3);
  EXPECT_EQ(bench.send(1, with_value({0x0B, 0x17}, static_cast<std::int32_t>(200)))->size, 8);
  bench.run(0.05);
  EXPECT_NEAR(bench.get<float>(1, 0x4D), 3.8, 1e-3);
  EXPECT_EQ(bench.get<std::int16_t>(1, 0x35), 200);
}

TEST(PowerCubeMotion, OverloadTripsTheI2tMonitor) {
  BusBench bench;
  bench.plants[0].lower = bench.plants[0].upper = 0.0;
  bench.set<std::uint32_t>(1, 0x39, 0x00080108);
  bench.send(1, with_value({0x0B, 0x08}, 9.5f));
  EXPECT_FALSE(bench.wait_for(1, bit::kIntegralErr, 19.5));
  EXPECT_TRUE(bench.wait_for(1, bit::kIntegralErr | bit::kPowerFault | bit::kError, 1.0));
  EXPECT_TRUE(bench.wait_for(1, bit::kBrakeActive, 1.0));
}

TEST(PowerCubeMotion, BadValuesAndLengthsMoveNothing) {
  BusBench bench;
  const auto before = bench.save();
  const float nan = std::nanf(""), infinite = INFINITY;
  for (const auto mode : {0x04, 0x07, 0x08, 0x0E, 0x11, 0x12})
    for (const float bad : {nan, infinite, -infinite})
      bench.send(1, with_value({0x0B, static_cast<std::uint8_t>(mode)}, bad));
  bench.send(1, BusBench::step(0x06, nan, 100));
  for (const auto mode : {0x00, 0x05, 0x18, 0x19, 0xFF})
    EXPECT_EQ(bench.send(1, with_value({0x0B, static_cast<std::uint8_t>(mode)}, 1.0f)), std::nullopt);
  for (const Message& cut : {Message{0x0B}, Message{0x0B, 0x04}, Message{0x0B, 0x04, 0x00}, Message{0x0A}})
    EXPECT_EQ(bench.send(1, cut), std::nullopt);
  bench.set(1, 0x48, nan);
  bench.set(1, 0x45, infinite);
  EXPECT_EQ(bench.save(), before);
}

// The ROS package amtec sends mode 18 (FCOSLOOP) with a target and a period in ms for its services sweep_pan
// and sweep_tilt, again and again until the answer carries 0B 18 (amtec_commands.c, amtecMotionFCosLoop).
TEST(PowerCubeMotion, ACosineLoopIsAnsweredAndGoesToItsTargetAndBackForEver) {
  BusBench bench;
  bench.ramp(1, 0.2f);
  bench.run(3.0);
  EXPECT_EQ(bench.send(1, BusBench::step(0x18, 0.5f, 4000)), (Message{0x0B, 0x18, 0x64}));
  for (int turn = 0; turn < 3; ++turn) {
    bench.run(1.0);
    EXPECT_NEAR(bench.position(1), 0.35, 2e-3) << turn;
    EXPECT_NEAR(bench.get<float>(1, 0x42), 0.15 * 2 * M_PI / 4, 5e-3) << "the speed in the middle";
    EXPECT_TRUE(bench.word(1) & bit::kMotion);
    bench.run(1.0);
    EXPECT_NEAR(bench.position(1), 0.5, 2e-3) << turn;
    bench.run(2.0);
    EXPECT_NEAR(bench.position(1), 0.2, 2e-3) << turn;
    EXPECT_TRUE(bench.word(1) & bit::kMotion) << "it turns and does not stand";
  }
  EXPECT_TRUE(bench.ramp(1, 0.3f));
  bench.run(3.0);
  EXPECT_NEAR(bench.position(1), 0.3, 1e-3);
  EXPECT_FALSE(bench.word(1) & (bit::kError | bit::kMotion));
}

TEST(PowerCubeMotion, ACosineLoopIsNoFasterThanTheLimitsAllow) {
  for (const std::uint16_t period_ms : {0, 1, 100}) {
    BusBench bench;
    bench.set(1, 0x50, 1.0f);  // target acceleration
    bench.send(1, BusBench::step(0x18, 0.5f, period_ms));
    double most = 0.0, fastest = 0.0;
    for (int i = 0; i < 4000; ++i) {
      bench.tick();
      most = std::max(most, static_cast<double>(bench.position(1)));
      fastest = std::max(fastest, static_cast<double>(bench.get<float>(1, 0x42)));
    }
    EXPECT_NEAR(most, 0.5, 5e-3) << period_ms;
    EXPECT_LT(fastest, 0.5 * M_PI / (M_PI * std::sqrt(2 * 0.5 / 1.0)) + 0.03) << period_ms;
    EXPECT_FALSE(bench.word(1) & bit::kError) << period_ms;
  }
}

TEST(PowerCubeMotion, ACosineLoopStopsFirstAndToWhereItStandsDoesNothing) {
  BusBench bench;
  bench.send(1, with_value({0x0B, 0x07}, 0.3f));
  bench.run(1.0);
  bench.send(1, BusBench::step(0x18, 0.0f, 3000));
  bench.run(20.0);
  EXPECT_FALSE(bench.word(1) & bit::kError);
  EXPECT_LT(bench.position(1), 0.5);
  const auto here = bench.position(2);
  bench.send(2, BusBench::step(0x18, here, 100));
  bench.run(0.5);
  EXPECT_NEAR(bench.position(2), here, 1e-4);
}

TEST(PowerCubeMotion, ACosineLoopBeyondASoftLimitTripsThere) {
  BusBench bench("", 0.001, 2.2);  // the limit is at 3.093
  EXPECT_EQ(bench.send(1, BusBench::step(0x18, 3.5f, 2000)), (Message{0x0B, 0x18, 0x64}));
  EXPECT_TRUE(bench.wait_for(1, bit::kBeyondSoft | bit::kError, 15.0));
  EXPECT_NEAR(bench.position(1), 3.093, 5e-3);
}

TEST(PowerCubeMotion, ASnapshotHoldsACosineLoop) {
  BusBench bench;
  bench.send(1, BusBench::step(0x18, 0.5f, 2000));
  bench.run(0.7);
  const auto kept = bench.save();
  bench.run(5.0);
  const auto position = bench.position(1);
  bench.load(kept);
  bench.run(5.0);
  EXPECT_EQ(bench.position(1), position);
}

TEST(PowerCubeMotion, AnUnhomedModuleLooksLikeAnErrorInTheShortState) {
  BusBench bench("homed: false");
  const auto answer = bench.send(1, {0x0A, 0x62});
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->size, 8);
  EXPECT_EQ(answer->data[6], 0x21);  // NOT_OK, RAMP_END
}

}  // namespace
}  // namespace visum::test
