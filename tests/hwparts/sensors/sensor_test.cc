// The behaviour of all sensors, tested with one that has a single number.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "tests/hwparts/sensors/bench.h"
#include "tests/support/temp_files.h"

namespace visum::sensors {
namespace {

using test::Bench;

const std::string kDistance = "kind: distance, range: [0.1, 5]";

std::vector<double> readings(Bench& bench, double truth, int count) {
  std::vector<double> all;
  for (int i = 0; i < count; ++i) {
    bench.tick({truth});
    all.push_back(bench.port("Distance"));
  }
  return all;
}

std::string fault_in(const std::string& yaml) {
  return visum::test::TempFiles().error_of([&] { Bench bench(yaml); });
}

TEST(Sensor, ReadsTheTruthWhereNothingIsAskedOfIt) {
  Bench bench(kDistance);
  EXPECT_EQ(bench.port("Changed"), 0.0) << "none yet";
  bench.tick({1.2345});
  EXPECT_EQ(bench.port("Distance"), 1.2345);
  EXPECT_EQ(bench.port("In Range"), 1.0);
  EXPECT_EQ(bench.port("Changed"), 1.0);
}

TEST(Sensor, ReadsTheEndOfItsRangeBeyondIt) {
  Bench bench(kDistance + ", noise: 0.1, bias: 0.1");
  bench.tick({std::numeric_limits<double>::infinity()});
  EXPECT_EQ(bench.port("Distance"), 5.0);
  EXPECT_EQ(bench.port("In Range"), 0.0);
  Bench exact(kDistance);
  exact.tick({0.05});
  EXPECT_EQ(exact.port("Distance"), 0.1);
  EXPECT_EQ(exact.port("In Range"), 0.0);
}

TEST(Sensor, ReadsNothingBeforeItsFirstSample) {
  Bench ray(kDistance + ", latency_ms: 3");
  ray.tick({0.2});
  EXPECT_EQ(ray.port("Changed"), 0.0);
  EXPECT_EQ(ray.port("Distance"), 5.0) << "not the shortest distance, which would be an obstacle";
  EXPECT_EQ(ray.port("In Range"), 0.0);
  Bench stuck(kDistance + ", failure: stuck");
  stuck.tick({0.2});
  EXPECT_EQ(stuck.port("Distance"), 5.0);

  Bench scanner("kind: scanner, range: [0.1, 5], rays: 4, angle: [-1, 1], latency_ms: 3");
  const auto scan = [&scanner] {
    const auto bytes = scanner.sensor->read_blackboard(0);
    std::vector<float> distances(bytes.size() / sizeof(float));
    std::memcpy(distances.data(), bytes.data(), bytes.size());
    return distances;
  };
  scanner.tick({0.2});
  EXPECT_EQ(scanner.port("Nearest Distance"), 5.0);
  EXPECT_EQ(scan(), std::vector<float>(4, 5.0f));
  for (int i = 0; i < 3; ++i) scanner.tick({0.2});
  EXPECT_EQ(scan(), std::vector<float>(4, 0.2f));
  scanner.reset();
  EXPECT_EQ(scan(), std::vector<float>(4, 5.0f));
}

TEST(Sensor, NoiseHasItsDeviationAndNoMean) {
  constexpr int kCount = 20'000;
  Bench bench(kDistance + ", noise: 0.02");
  const auto [mean, deviation] = test::statistics_of(readings(bench, 2.0, kCount));
  EXPECT_NEAR(mean, 2.0, 5 * 0.02 / std::sqrt(kCount));
  EXPECT_NEAR(deviation, 0.02, 5 * 0.02 / std::sqrt(2.0 * kCount));
}

TEST(Sensor, AShareOfNoiseGrowsWithTheTruth) {
  constexpr int kCount = 20'000;
  Bench bench(kDistance + ", noise_share: 0.01");
  EXPECT_NEAR(test::statistics_of(readings(bench, 1.0, kCount)).deviation, 0.01, 3e-4);
  EXPECT_NEAR(test::statistics_of(readings(bench, 4.0, kCount)).deviation, 0.04, 12e-4);
}

// Over many sensors the offsets have the configured deviation. The offset of one sensor never changes.
TEST(Sensor, ABiasIsDrawnOnceForEachSensor) {
  std::vector<double> offsets;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    Bench bench(kDistance + ", bias: 0.05", seed);
    const auto two = readings(bench, 2.0, 2);
    ASSERT_EQ(two[0], two[1]);
    offsets.push_back(two[0] - 2.0);
  }
  const auto [mean, deviation] = test::statistics_of(offsets);
  EXPECT_NEAR(mean, 0.0, 5 * 0.05 / std::sqrt(2000));
  EXPECT_NEAR(deviation, 0.05, 5 * 0.05 / std::sqrt(4000));
}

TEST(Sensor, ReadsInSteps) {
  Bench bench(kDistance + ", resolution: 0.25");
  EXPECT_EQ(readings(bench, 1.37, 1).back(), 1.25);
  EXPECT_EQ(readings(bench, 1.38, 1).back(), 1.5);
}

// 30 Hz with ticks of 1 ms is a period of 33.3 ticks. In 3 s there must be exactly 90 readings.
TEST(Sensor, ItsRateNeedNotDivideTheTicks) {
  Bench bench(kDistance + ", rate_hz: 30");
  int due = 0;
  for (int i = 0; i < 3000; ++i) {
    due += bench.sensor->due();
    bench.tick({1.0});
    if (i == 32 || i == 33) {
      EXPECT_EQ(bench.port("Changed"), i - 32.0) << "the first after one period";
    }
  }
  EXPECT_EQ(due, 90);
  EXPECT_EQ(bench.port("Changed"), 90.0);
}

TEST(Sensor, ShowsAReadingAfterItsLatency) {
  Bench bench(kDistance + ", latency_ms: 7");
  for (int i = 1; i <= 50; ++i) {
    bench.tick({0.1 * i});
    if (i > 7)
      ASSERT_EQ(bench.port("Distance"), std::clamp(0.1 * (i - 7), 0.1, 5.0)) << i;
    else
      ASSERT_EQ(bench.port("Changed"), 0.0) << i;
  }
}

// Samples fall on the ends of ticks, so one more can be on its way than the period alone suggests.
TEST(Sensor, HoldsAllReadingsOfADelayWhateverItsRate) {
  for (const double hz : {1000.0, 750.0, 666.0, 501.0, 333.0, 123.0}) {
    for (const int latency_ms : {0, 1, 3, 7}) {
      SCOPED_TRACE(std::to_string(hz) + " Hz, " + std::to_string(latency_ms) + " ms");
      const std::string yaml = kDistance + ", rate_hz: " + std::to_string(hz) +
                               ", latency_ms: " + std::to_string(latency_ms) + ", failure: delayed";
      Bench bench(yaml), other(yaml);
      std::vector<double> taken;
      for (int i = 0; i < 300; ++i) {
        if (bench.sensor->due()) taken.push_back(0.2 + 0.01 * i);
        bench.tick({0.2 + 0.01 * i});
        const auto shown = static_cast<std::size_t>(bench.port("Changed"));
        if (shown > 0) {
          ASSERT_EQ(bench.port("Distance"), taken[shown - 1]) << "none is lost, none goes before another";
        }
        std::vector<std::byte> kept;
        hwparts::StateWriter to(kept);
        bench.sensor->save(to);
        hwparts::StateReader from(kept);
        ASSERT_NO_THROW(other.sensor->load(from)) << i;
      }
      EXPECT_LE(static_cast<double>(taken.size()) - bench.port("Changed"), 11.0 + latency_ms);
    }
  }
}

TEST(ReadingQueue, RefusesWhatItHasNoRoomFor) {
  ReadingQueue queue(2, 1);
  EXPECT_TRUE(queue.push(1, std::vector{1.0}));
  EXPECT_TRUE(queue.push(2, std::vector{2.0}));
  EXPECT_FALSE(queue.push(3, std::vector{3.0}));
  EXPECT_EQ(queue.front()[0], 1.0);
  queue.pop();
  EXPECT_EQ(queue.front()[0], 2.0);
}

TEST(Sensor, BelievesNoStateThatFailsInAWayOfItsOwn) {
  Bench bench(kDistance);
  std::vector<std::byte> kept;
  hwparts::StateWriter to(kept);
  bench.sensor->save(to);
  kept.at(4 * sizeof(std::uint64_t)) = std::byte{200};  // behind the random numbers
  hwparts::StateReader from(kept);
  EXPECT_THROW(bench.sensor->load(from), std::out_of_range);
}

// A fault on purpose acts as the sensor's parameter does, and ends when the fault ends.
TEST(Sensor, FaultsAreItsFailuresAndEnd) {
  const std::pair<const char*, const char*> pairs[]{{"sensor_off", "off"},
                                                    {"sensor_frozen", "stuck"},
                                                    {"sensor_garbage", "garbage"},
                                                    {"sensor_wrong", "wrong"},
                                                    {"sensor_slow", "slow"},
                                                    {"sensor_delayed", "delayed"},
                                                    {"sensor_intermittent", "intermittent"}};
  for (const auto& [fault, failure] : pairs) {
    SCOPED_TRACE(fault);
    Bench broken(kDistance + ", noise: 0.01"), failing(kDistance + ", noise: 0.01");
    EXPECT_EQ(readings(broken, 1.0, 3), readings(failing, 1.0, 3));
    std::string why;
    const auto made = hwparts::make_fault(fault, {}, why);
    ASSERT_TRUE(made) << why;
    const hwparts::ActiveFault active{0, *made, 0};
    broken.sensor->set_faults({&active, 1});
    failing.fail(failure);
    EXPECT_EQ(readings(broken, 2.0, 40), readings(failing, 2.0, 40));
    EXPECT_EQ(broken.port("Changed"), failing.port("Changed"));
    broken.sensor->set_faults({});
    failing.fail("ok");
    EXPECT_EQ(readings(broken, 3.0, 40), readings(failing, 3.0, 40));
  }
}

TEST(Sensor, OffStandsStillAndGoesOnAgain) {
  Bench bench(kDistance);
  readings(bench, 1.0, 3);
  bench.fail("off");
  EXPECT_FALSE(bench.sensor->due());
  EXPECT_EQ(readings(bench, 2.0, 5).back(), 1.0);
  EXPECT_EQ(bench.port("Changed"), 3.0);
  bench.fail("ok");
  EXPECT_EQ(readings(bench, 2.0, 1).back(), 2.0);
}

TEST(Sensor, OffStaysOffWhateverFaultActs) {
  for (const char* fault : {"sensor_slow", "sensor_wrong", "sensor_delayed", "sensor_garbage"}) {
    Bench bench(kDistance);
    bench.fail("off");
    std::string why;
    const auto made = hwparts::make_fault(fault, {}, why);
    ASSERT_TRUE(made) << why;
    const hwparts::ActiveFault active{0, *made, 0};
    bench.sensor->set_faults({&active, 1});
    readings(bench, 2.0, 40);
    EXPECT_EQ(bench.port("Changed"), 0.0) << fault;
  }
}

TEST(Sensor, StuckRepeatsTheLastReading) {
  Bench bench(kDistance + ", noise: 0.01");
  const double last = readings(bench, 1.0, 3).back();
  bench.fail("stuck");
  for (const double reading : readings(bench, 2.0, 5)) EXPECT_EQ(reading, last);
  EXPECT_EQ(bench.port("Changed"), 8.0) << "it does not know of its failure";
}

TEST(Sensor, GarbageIsAnythingInItsRange) {
  constexpr int kCount = 20'000;
  Bench bench(kDistance);
  bench.fail("garbage");
  const auto [mean, deviation] = test::statistics_of(readings(bench, 1.0, kCount));
  EXPECT_NEAR(mean, 2.55, 0.06);
  EXPECT_NEAR(deviation, 4.9 / std::sqrt(12.0), 0.04);
}

TEST(Sensor, WrongIsMirroredInItsRange) {
  Bench bench(kDistance);
  bench.fail("wrong");
  EXPECT_NEAR(readings(bench, 1.0, 1).back(), 4.1, 1e-12);
}

TEST(Sensor, SlowTakesOneReadingOfTen) {
  Bench bench(kDistance + ", failure: slow");
  readings(bench, 1.0, 100);
  EXPECT_EQ(bench.port("Changed"), 10.0);
}

TEST(Sensor, DelayedIsTenSamplesLate) {
  Bench bench(kDistance + ", latency_ms: 2, failure: delayed");
  for (int i = 1; i <= 40; ++i) bench.tick({0.1 * i});
  EXPECT_NEAR(bench.port("Distance"), 0.1 * (40 - 12), 1e-12);
  bench.fail("ok");
  for (int i = 41; i <= 60; ++i) bench.tick({0.1 * 41});
  EXPECT_NEAR(bench.port("Distance"), 0.1 * 41, 1e-12)
      << "in time again, once what was on its way is through";
}

TEST(Sensor, WhenADelayEndsWhatIsUnderWayIsDueByItsLatencyAlone) {
  Bench bench(kDistance + ", latency_ms: 2, failure: delayed");
  for (int i = 1; i <= 40; ++i) bench.tick({0.1 * i});
  bench.fail("ok");
  bench.tick({4.1});
  EXPECT_NEAR(bench.port("Distance"), 0.1 * 39, 1e-12);
  EXPECT_EQ(bench.port("Changed"), 39.0) << "none is lost";
}

// Readings that were on their way before the delay began keep their latency. A delay that is shorter than the
// latency is never seen.
TEST(Sensor, ADelayThatIsOverBeforeItsFirstReadingIsDueIsNotSeen) {
  Bench bench(kDistance + ", latency_ms: 7");
  const hwparts::ActiveFault late{0, {hwparts::FaultKind::kSensorDelayed, {}}, 0};
  for (int i = 1; i <= 40; ++i) {
    if (i == 11) bench.sensor->set_faults({&late, 1});
    if (i == 16) bench.sensor->set_faults({});
    bench.tick({0.1 * i});
    ASSERT_EQ(bench.port("Changed"), std::max(0, i - 7)) << i;
    if (i > 7) {
      ASSERT_EQ(bench.port("Distance"), std::clamp(0.1 * (i - 7), 0.1, 5.0)) << i;
    }
  }
}

TEST(Sensor, ASilentOneShowsWhatCameLastWhenTheSilenceEnds) {
  const std::string slow = kDistance + ", rate_hz: 10, latency_ms: 7";
  Bench bench(slow), restored(slow);
  const hwparts::ActiveFault silent{0, {hwparts::FaultKind::kPartSilent, {}}, 0};
  EXPECT_EQ(readings(bench, 1.0, 150).back(), 1.0);
  for (auto* one : {&bench, &restored}) one->sensor->set_faults({&silent, 1});
  EXPECT_EQ(readings(bench, 2.0, 100).back(), 1.0);
  EXPECT_EQ(readings(bench, 3.0, 100).back(), 1.0);
  EXPECT_EQ(bench.port("Changed"), 1.0);
  std::vector<std::byte> kept;
  hwparts::StateWriter to(kept);
  bench.sensor->save(to);
  hwparts::StateReader from(kept);
  restored.sensor->load(from);
  for (auto* one : {&bench, &restored}) {
    one->sensor->set_faults({});
    EXPECT_EQ(readings(*one, 4.0, 1).back(), 3.0) << "the next sample is 50 ticks away";
    EXPECT_EQ(one->port("Changed"), 3.0) << "those that nobody heard count";
  }
}

// The reading that waits takes no slot from those on their way, at any rate.
TEST(Sensor, ASilenceOfALateOneLosesNoReadingThatComesAfterIt) {
  for (const double hz : {1000.0, 666.0, 123.0}) {
    Bench silent(kDistance + ", latency_ms: 7, failure: delayed, rate_hz: " + std::to_string(hz));
    Bench heard(kDistance + ", latency_ms: 7, failure: delayed, rate_hz: " + std::to_string(hz));
    const hwparts::ActiveFault fault{0, {hwparts::FaultKind::kPartSilent, {}}, 0};
    for (int i = 0; i < 600; ++i) {
      if (i == 200) silent.sensor->set_faults({&fault, 1});
      if (i == 400) silent.sensor->set_faults({});
      for (auto* one : {&silent, &heard}) one->tick({0.2 + 0.005 * i});
      if (i >= 400) {
        ASSERT_EQ(silent.outputs, heard.outputs) << i << " at " << hz << " Hz";
      }
    }
  }
}

TEST(Sensor, IntermittentLosesHalfOfTheReadings) {
  Bench bench(kDistance + ", failure: intermittent");
  readings(bench, 1.0, 10'000);
  EXPECT_NEAR(bench.port("Changed"), 5000.0, 5 * 50.0);
}

TEST(Sensor, AFailureThatThereIsNotIsRefused) {
  Bench bench(kDistance);
  EXPECT_EQ(bench.sensor->set_parameter("Failure", std::string("odd")),
            "must be one of ok, off, stuck, garbage, wrong, slow, delayed, intermittent");
  EXPECT_EQ(bench.sensor->set_parameter("Failure", 1.0),
            "must be one of ok, off, stuck, garbage, wrong, slow, delayed, intermittent");
  EXPECT_EQ(bench.sensor->set_parameter("Rate", 1.0), "'Rate' can only be read");
  EXPECT_EQ(bench.sensor->set_parameter("Colour", 1.0),
            "there is no parameter 'Colour'; there are: Failure, Rate, Latency");
  EXPECT_EQ(bench.sensor->set_parameter("Falure", 1.0),
            "there is no parameter 'Falure'; did you mean 'Failure'?");
}

TEST(Sensor, WrongEntriesAreRefusedWhereTheyAreWrong) {
  EXPECT_EQ(fault_in("kind: distanse, range: [0, 1]"),
            "sensor:1: kind: must be one of distance, scanner, imu, pose, contact, joint_wrench, camera, is "
            "'distanse'; did you mean 'distance'?");
  EXPECT_EQ(fault_in("kind: distance"), "sensor:1: key 'range' is missing");
  EXPECT_EQ(fault_in("kind: distance, range: [2, 1]"),
            "sensor:1: range: must be [lowest, highest], the lowest first");
  EXPECT_EQ(fault_in("kind: distance, range: [0, .inf]"),
            "sensor:1: range[1]: must be a finite number, is .inf");
  EXPECT_EQ(fault_in(kDistance + ", nois: 1"), "sensor:1: unknown key 'nois'; did you mean 'noise'?");
  EXPECT_EQ(fault_in(kDistance + ", noise: -1"), "sensor:1: noise: must be between 0 and 4.9, is -1");
  EXPECT_EQ(fault_in(kDistance + ", rate_hz: 2000"),
            "sensor:1: rate_hz: must be between 0.001 and 1000, is 2000");
  EXPECT_EQ(fault_in(kDistance + ", latency_ms: 101"),
            "sensor:1: latency_ms: must be between 0 and 100, is 101");
  EXPECT_EQ(fault_in(kDistance + ", failure: broken").substr(0, 40),
            "sensor:1: failure: must be one of ok, of");
  EXPECT_EQ(fault_in("kind: scanner, range: [0, 1], angle: [-1, 1], rays: 1"),
            "sensor:1: rays: must be a whole number between 2 and 4096, is 1");
  EXPECT_EQ(fault_in("kind: scanner, range: [0, 1], angle: [1, -1], rays: 9"),
            "sensor:1: angle: must be [first, last], the smaller first");
  EXPECT_EQ(fault_in("kind: imu, gyro: {nose: 1}"),
            "sensor:1: gyro: unknown key 'nose'; did you mean 'noise'?");
  EXPECT_EQ(fault_in("kind: pose, orientation: {noise: 1}"),
            "sensor:1: orientation.noise: must be between 0 and 0.5, is 1");
  EXPECT_EQ(fault_in("kind: contact, range: 10, threshold: 11"),
            "sensor:1: threshold: must be between 0 and 10, is 11");
}

}  // namespace
}  // namespace visum::sensors
