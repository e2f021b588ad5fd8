// Every row of the table of kinds, and the particular behaviour of some.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "tests/hwparts/sensors/bench.h"

namespace visum::sensors {
namespace {

using test::Bench;

struct Entry {
  const char* name;
  const char* yaml;  // with all of its own keys
};
const Entry kEntries[] = {
    {"distance",
     "kind: distance, range: [0.1, 5], noise: 0.01, noise_share: 0.01, bias: 0.01, resolution: 1e-3"},
    {"scanner", "kind: scanner, range: [0.1, 5], rays: 31, angle: [-1, 1], noise: 0.01, bias: 0.01"},
    {"imu", "kind: imu, gyro: {range: 10, noise: 0.01, bias: 0.1}, accelerometer: {range: 100, noise: 0.1}"},
    {"pose", "kind: pose, position: {noise: 0.01}, orientation: {noise: 0.01}"},
    {"contact", "kind: contact, range: 100, threshold: 1, noise: 0.1"},
    {"camera", "kind: camera, shows: color, size: [32, 24], fov_deg: 60, noise: 0.01"},
    {"joint_wrench", "kind: joint_wrench, joint: a, force: {noise: 0.1}, torque: {noise: 0.1, range: 50}"},
};

class EverySensor : public testing::TestWithParam<Entry> {
 protected:
  static std::string timed() { return std::string(GetParam().yaml) + ", rate_hz: 300, latency_ms: 12"; }
  // A truth that changes. It also serves a kind whose truth must contain a unit quaternion.
  static void run(Bench& bench, int ticks, int from = 0) {
    for (int i = from; i < from + ticks; ++i) {
      const double angle = 0.01 * i;
      bench.tick({angle, 1.0 + angle, 2.0, std::cos(angle), std::sin(angle), 0.0});
    }
  }
  static std::vector<std::byte> saved(const Bench& bench) {
    std::vector<std::byte> bytes;
    {
      hwparts::StateWriter writer(bytes);
      bench.sensor->save(writer);
    }
    return bytes;
  }
};

TEST_P(EverySensor, IsInTheTestsTable) {
  EXPECT_EQ(std::size(kEntries), sensor_kinds().size());
  EXPECT_TRUE(std::ranges::any_of(sensor_kinds(),
                                  [](const auto& row) { return std::string(row.name) == GetParam().name; }));
}

TEST_P(EverySensor, StaysInItsPortsRangesWhateverFails) {
  Bench bench(timed());
  for (const auto& row : failure_names()) {
    if (bench.sensor->set_parameter("Failure", std::string(row.name))) continue;  // not in this way
    run(bench, 200);
    const auto& ports = bench.sensor->description().sensor_outputs;
    for (std::size_t i = 0; i < ports.size(); ++i)
      EXPECT_TRUE(bench.outputs[i] >= ports[i].minimum && bench.outputs[i] <= ports[i].maximum)
          << row.name << ": " << ports[i].name << " is " << bench.outputs[i];
  }
}

TEST_P(EverySensor, GoesOnFromASavedStateWithTheSameBits) {
  Bench straight(timed()), restored(timed());
  run(straight, 100);
  const auto bytes = saved(straight);
  const auto outputs = straight.outputs;
  run(restored, 57);
  restored.fail("stuck");
  hwparts::StateReader reader(bytes);
  restored.sensor->load(reader);
  EXPECT_TRUE(reader.at_end());
  restored.outputs = outputs;
  EXPECT_EQ(saved(restored), bytes);
  run(straight, 100, 100);
  run(restored, 100, 100);
  EXPECT_EQ(straight.outputs, restored.outputs);
  EXPECT_EQ(saved(straight), saved(restored));
}

TEST_P(EverySensor, ResetGoesBackToTheFirstBits) {
  Bench bench(timed());
  const auto first = saved(bench);
  run(bench, 100);
  const auto after = bench.outputs;
  EXPECT_NE(saved(bench), first);
  bench.reset();
  EXPECT_EQ(saved(bench), first);
  run(bench, 100);
  EXPECT_EQ(bench.outputs, after);
}

TEST_P(EverySensor, NamesItsPortsOnce) {
  std::set<std::string> names;
  Bench bench(timed());
  for (const auto& port : bench.sensor->description().sensor_outputs)
    EXPECT_TRUE(names.insert(port.name).second) << port.name;
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySensor, testing::ValuesIn(kEntries),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(Scanner, PutsAllDistancesOnItsBlackboardAndTheNearestOnPorts) {
  Bench bench("kind: scanner, range: [0.1, 5], rays: 5, angle: [-1, 1]");
  const auto& board = bench.sensor->description().blackboards.at(0);
  EXPECT_EQ(board.name, "scan");
  bench.tick({1.0, 2.0, INFINITY, 0.5, 0.01});
  float scan[5];
  const auto bytes = bench.sensor->read_blackboard(0);
  ASSERT_EQ(bytes.size(), sizeof scan);
  ASSERT_EQ(bytes.size(), board.element_size * board.elements);
  std::memcpy(scan, bytes.data(), sizeof scan);
  EXPECT_EQ((std::vector<float>(scan, scan + 5)), (std::vector<float>{1.0f, 2.0f, 5.0f, 0.5f, 0.1f}));
  EXPECT_EQ(bench.port("Nearest Distance"), 0.1);
  EXPECT_EQ(bench.port("Nearest Angle"), 1.0);
  EXPECT_EQ(bench.port("Rays In Range"), 3.0);
}

TEST(Contact, IsFeltAboveItsThreshold) {
  Bench bench("kind: contact, threshold: 2, range: 10");
  bench.tick({1.9});
  EXPECT_EQ(bench.port("Contact"), 0.0);
  bench.tick({2.1});
  EXPECT_EQ(bench.port("Contact"), 1.0);
  EXPECT_EQ(bench.port("Normal Force"), 2.1);
  bench.tick({50.0});
  EXPECT_EQ(bench.port("Normal Force"), 10.0);
}

// Small turns about each axis have the configured deviation, and the quaternion keeps its unit length.
TEST(Pose, OrientationNoiseIsATurnAboutAnyAxis) {
  constexpr int kCount = 20'000;
  Bench bench("kind: pose, orientation: {noise: 0.01}");
  std::vector<double> turns[3];
  for (int i = 0; i < kCount; ++i) {
    bench.tick({1, 2, 3, 1, 0, 0, 0});
    const double w = bench.port("Orientation W"), x = bench.port("Orientation X"),
                 y = bench.port("Orientation Y"), z = bench.port("Orientation Z");
    ASSERT_NEAR(w * w + x * x + y * y + z * z, 1.0, 1e-12);
    turns[0].push_back(2 * x);
    turns[1].push_back(2 * y);
    turns[2].push_back(2 * z);
  }
  for (const auto& axis : turns) {
    EXPECT_NEAR(test::statistics_of(axis).mean, 0.0, 5 * 0.01 / std::sqrt(kCount));
    EXPECT_NEAR(test::statistics_of(axis).deviation, 0.01, 5 * 0.01 / std::sqrt(2.0 * kCount) + 1e-6);
  }
  EXPECT_EQ(bench.port("Position Y"), 2.0);
}

}  // namespace
}  // namespace visum::sensors
