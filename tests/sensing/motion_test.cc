// IMU, pose and contact sensors, from the scene to the ports, against closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensing/world_bench.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;
using test::WorldBench;

// A turntable at 3 rad/s, the sensor 0.4 m from its axis with x outwards, y along the motion: it feels the
// turn about z, the centripetal acceleration -ω² r along x, and its weight.
TEST(Imu, OnATurntableFeelsTurnCentripetalAccelerationAndGravity) {
  WorldBench bench(R"(
engine: impulse
bodies: [{name: table, mass: 5, velocity: {angular: [0, 0, 3]}, shapes: [{cylinder: {radius: 0.5, length: 0.1}}]}]
joints: [{name: axle, type: hinge, child: table, axis: [0, 0, 1]}]
sensors: [{name: imu, kind: imu, body: table, pose: {xyz: [0.4, 0, 0]}}]
)");
  bench.run(500);
  EXPECT_NEAR((bench.axes("imu", "Angular Rate") - Vector3d(0, 0, 3)).norm(), 0.0, 1e-6);
  const Vector3d a = bench.axes("imu", "Acceleration");
  EXPECT_NEAR(a.x(), -9.0 * 0.4, 1e-3);
  // The mean over the last tick lags by half of it: ω² r sin(ω h/2) along y.
  EXPECT_NEAR(a.y(), 9.0 * 0.4 * 3.0 * 0.5e-3, 1e-3);
  EXPECT_NEAR(a.z(), 9.81, 1e-6);
}

TEST(Imu, InFreeFallFeelsNothingAndAtRestItsWeight) {
  WorldBench bench(R"(
engine: impulse
bodies: [{name: stone, mass: 1, pose: {rpy: [0.3, 0.2, 0.1]}, shapes: [{sphere: 0.1}]}]
sensors:
  - {name: falling, kind: imu, body: stone}
  - {name: standing, kind: imu, pose: {rpy: [0, 1.5707963267948966, 0]}}
)");
  bench.run(50);
  EXPECT_NEAR(bench.axes("falling", "Acceleration").norm(), 0.0, 1e-9);
  EXPECT_NEAR((bench.axes("standing", "Acceleration") - Vector3d(-9.81, 0, 0)).norm(), 0.0, 1e-12)
      << "x points down";
}

TEST(PoseSensor, TellsWhereItsFrameIs) {
  WorldBench bench(R"(
engine: impulse
gravity: [0, 0, 0]
bodies:
  - {name: puck, mass: 1, velocity: {linear: [0.5, 0, 0], angular: [0, 0, 1]}, shapes: [{sphere: 0.1}]}
sensors: [{name: tracker, kind: pose, body: puck, pose: {xyz: [0.2, 0, 0]}}]
)");
  bench.run(1000);
  const Vector3d expected(0.5 + 0.2 * std::cos(1.0), 0.2 * std::sin(1.0), 0.0);
  EXPECT_NEAR((bench.axes("tracker", "Position") - expected).norm(), 0.0, 1e-6);
  EXPECT_NEAR(bench.port("tracker", "Orientation W"), std::cos(0.5), 1e-6);
  EXPECT_NEAR(bench.port("tracker", "Orientation Z"), std::sin(0.5), 1e-6);
}

class ContactSensor : public testing::TestWithParam<const char*> {};

TEST_P(ContactSensor, FeelsTheWeightOfWhatStandsOnIt) {
  WorldBench bench(std::string("engine: ") + GetParam() + R"(
bodies:
  - {name: plate, fixed: true, shapes: [{box: [1, 1, 0.1]}]}
  - {name: box, mass: 2, pose: {xyz: [0, 0, 0.35]}, shapes: [{box: [0.2, 0.2, 0.2]}]}
sensors:
  - {name: scale, kind: contact, body: plate}
  - {name: foot, kind: contact, body: box, threshold: 5}
)");
  bench.run(100);
  EXPECT_EQ(bench.port("scale", "Contact"), 0.0) << "still falling";
  bench.run(1900);
  EXPECT_EQ(bench.port("scale", "Contact"), 1.0);
  EXPECT_NEAR(bench.port("scale", "Normal Force"), 2 * 9.81, 0.05);
  EXPECT_EQ(bench.port("foot", "Contact"), 1.0);
}

INSTANTIATE_TEST_SUITE_P(Engines, ContactSensor, testing::Values("impulse", "ode"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace visum::sensing
