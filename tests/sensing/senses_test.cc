// Sensors in the world's life: hash, snapshots, reset, bodies that come and go, scenes that are wrong.
#include "server/sensing/senses.h"

#include <gtest/gtest.h>

#include "hwparts/sensors/sensor_kinds.h"
#include "tests/sensing/world_bench.h"

namespace visum::sensing {
namespace {

using test::WorldBench;

const std::string kWorld = R"(
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: ball, mass: 1, pose: {xyz: [0, 0, 1]}, velocity: {linear: [1, 0, 0]}, shapes: [{sphere: 0.1}]}
  - {name: spare, mass: 1, pose: {xyz: [9, 0, 1]}, shapes: [{sphere: 0.1}]}
  - {name: last, mass: 1, pose: {xyz: [0, 5, 1]}, shapes: [{sphere: 0.1}]}
sensors:
  - {name: eye, kind: distance, range: [0.01, 9], pose: {xyz: [-2, 0, 0.95]}, rate_hz: 130, noise: 0.01}
  - {name: fan, kind: scanner, range: [0.01, 9], rays: 21, angle: [-1, 1], body: last, latency_ms: 3, noise: 0.01}
  - {name: imu, kind: imu, body: ball, gyro: {noise: 0.1, bias: 0.1}}
  - {name: tracker, kind: pose, body: ball, position: {noise: 0.1}, orientation: {noise: 0.1}}
  - {name: bumper, kind: contact, body: ball, noise: 0.1}
)";

TEST(Senses, EveryKindOfSensorHasItsProbe) {
  ASSERT_EQ(probe_kinds().size(), sensors::sensor_kinds().size());
  for (std::size_t i = 0; i < probe_kinds().size(); ++i)
    EXPECT_STREQ(probe_kinds()[i].name, sensors::sensor_kinds()[i].name);
}

TEST(Senses, TwoRunsHaveTheSameHashAtEveryTick) {
  WorldBench a(kWorld), b(kWorld);
  for (int i = 0; i < 200; ++i) {
    a.run(1);
    b.run(1);
    ASSERT_EQ(a.simulation.state_hash(), b.simulation.state_hash()) << "tick " << i;
  }
}

TEST(Senses, ASnapshotGoesOnWithTheSameBits) {
  WorldBench bench(kWorld);
  bench.run(57);
  const auto snapshot = bench.simulation.take_snapshot();
  bench.run(200);
  const auto later = bench.simulation.state_hash();
  ASSERT_TRUE(bench.simulation.restore_snapshot(snapshot));
  bench.run(200);
  EXPECT_EQ(bench.simulation.state_hash(), later);
}

TEST(Senses, ResetAndSeedAreThoseOfTheWorld) {
  WorldBench bench(kWorld), other("seed: 2" + kWorld);
  const auto first = bench.simulation.state_hash();
  bench.run(100);
  const double reading = bench.port("eye", "Distance");
  bench.simulation.reset();
  EXPECT_EQ(bench.simulation.state_hash(), first);
  EXPECT_EQ(bench.port("eye", "Changed"), 0.0);
  bench.run(100);
  EXPECT_EQ(bench.port("eye", "Distance"), reading);
  other.run(100);
  EXPECT_NE(other.port("eye", "Distance"), reading);
}

TEST(Senses, OneSensorMoreChangesNoOther) {
  WorldBench few(kWorld), more(kWorld + "  - {name: zz, kind: imu, gyro: {noise: 1}}\n");
  few.run(100);
  more.run(100);
  for (const char* name : {"eye", "fan", "imu", "tracker", "bumper"})
    EXPECT_EQ(few.part(name).sensor_outputs, more.part(name).sensor_outputs) << name;
}

TEST(Senses, ComeAlongWhenBodiesComeAndGo) {
  WorldBench bench("gravity: [0, 0, 0]" + kWorld);
  bench.run(10);
  EXPECT_EQ(bench.simulation.remove_body("ball"), "it carries the sensor 'imu'");
  EXPECT_EQ(bench.simulation.remove_body("spare"), "");
  bench.simulation.add_body(
      "{name: wall, fixed: true, pose: {xyz: [2, 5, 1]}, shapes: [{box: [0.2, 9, 9]}]}");
  bench.run(10);
  EXPECT_NEAR(bench.port("fan", "Nearest Distance"), 1.9, 0.1) << "on 'last' still, whose number has changed";
  EXPECT_GT(bench.port("fan", "Changed"), 10.0);
}

TEST(Senses, StandWhereTheirFileIsPutAndInFrames) {
  const visum::test::TempFiles files;
  files.write("inner.yaml", R"(visum: 1
parameters: {name: tracker}
sensors: [{name: "${name}", kind: pose, pose: {xyz: [1, 0, 0]}}]
)");
  cycle::Simulation simulation(scene::load_scene(files.write("outer.yaml", R"(visum: 1
frames: [{name: mast, pose: {xyz: [0, 0, 5]}}]
include: [{file: inner.yaml, pose: {xyz: [0, 0, 2]}}, {file: inner.yaml, parameters: {name: other}}]
sensors: [{name: high, kind: pose, pose: {in: mast, xyz: [0, 3, 0]}}]
)")));
  simulation.tick();
  const auto position = [&](std::size_t sensor) {
    return Eigen::Vector3d(simulation.parts()[sensor].sensor_outputs.data());
  };
  EXPECT_EQ(position(0), Eigen::Vector3d(1, 0, 2));
  EXPECT_EQ(position(1), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(position(2), Eigen::Vector3d(0, 3, 5));
}

std::string sensor_error(const std::string& sensor) {
  const visum::test::TempFiles files;
  const auto file = files.write("s.yaml", R"(visum: 1
bodies: [{name: box, mass: 1, shapes: [{sphere: 1}]}]
joints: [{name: hinge, type: hinge, child: box, axis: [0, 0, 1]}]
sensors:
)" + sensor + "\n");
  return files.error_of([&] { cycle::Simulation simulation(scene::load_scene(file)); });
}

TEST(Senses, WrongScenesAreRefusedWhereTheyAreWrong) {
  EXPECT_EQ(sensor_error("- {kind: imu}"), "s.yaml:5: sensors[0]: key 'name' is missing");
  EXPECT_EQ(sensor_error("- {name: a}"), "s.yaml:5: sensors[0]: key 'kind' is missing");
  EXPECT_EQ(sensor_error("- {name: a, kind: imu}\n- {name: a, kind: imu}"),
            "s.yaml:6: sensors[1]: there is already a part 'a' (s.yaml:5)");
  EXPECT_EQ(sensor_error("- {name: a, kind: imo}"),
            "s.yaml:5: sensors[0].kind: must be one of distance, scanner, imu, pose, contact, joint_wrench, "
            "camera, is "
            "'imo'; did you mean 'imu'?");
  EXPECT_EQ(sensor_error("- {name: a, kind: imu, body: bax}"),
            "s.yaml:5: sensors[0].body: there is no body 'bax'; did you mean 'box'?");
  EXPECT_EQ(sensor_error("- {name: a, kind: imu, pose: {xyz: [0, 0]}}"),
            "s.yaml:5: sensors[0].pose.xyz: must be a list of 3 numbers, has 2");
  EXPECT_EQ(sensor_error("- {name: a, kind: contact}"),
            "s.yaml:5: sensors[0]: a contact sensor needs 'body': what it feels touches that");
  EXPECT_EQ(sensor_error("- {name: a, kind: joint_wrench, joint: hing}"),
            "s.yaml:5: sensors[0].joint: there is no joint 'hing'; did you mean 'hinge'?");
  EXPECT_EQ(sensor_error("- {name: a, kind: imu, joint: hinge}"),
            "s.yaml:5: sensors[0]: unknown key 'joint'");
  EXPECT_EQ(sensor_error("  {name: a}"), "s.yaml:5: sensors: must be a list, is a map");
}

}  // namespace
}  // namespace visum::sensing
