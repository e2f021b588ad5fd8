// Distance sensors and scanners, from the scene to the ports, against closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/sensing/world_bench.h"

namespace visum::sensing {
namespace {

using test::WorldBench;

const std::string kWall = R"(
bodies:
  - {name: wall, fixed: true, pose: {xyz: [3, 0, 0], rpy: [0, 0, 0.4]}, shapes: [{box: [0.2, 40, 4]}]}
)";

// Against a wall whose normal is turned by 0.4 rad and that is 3 m ahead, less half of its thickness:
// the ray at angle a meets it at (3 cos 0.4 - 0.1) / cos(a - 0.4).
double to_wall(double angle) {
  return (3.0 * std::cos(0.4) - 0.1) / std::cos(angle - 0.4);
}

TEST(DistanceSensor, MeasuresAnObliqueWall) {
  for (const double angle : {-0.5, 0.0, 0.4, 1.2}) {
    WorldBench bench(kWall + "sensors: [{name: eye, kind: distance, range: [0.1, 20], pose: {rpy: [0, 0, " +
                     std::to_string(angle) + "]}}]\n");
    bench.run(1);
    EXPECT_NEAR(bench.port("eye", "Distance"), to_wall(angle), 1e-12) << angle;
    EXPECT_EQ(bench.port("eye", "In Range"), 1.0);
  }
}

TEST(DistanceSensor, MeasuresABallOffItsCentre) {
  WorldBench bench(R"(
bodies: [{name: ball, fixed: true, pose: {xyz: [4, 0.3, 0]}, shapes: [{sphere: 0.5}]}]
sensors: [{name: eye, kind: distance, range: [0.1, 20]}]
)");
  bench.run(1);
  EXPECT_NEAR(bench.port("eye", "Distance"), 4.0 - 0.4, 1e-12);
}

// Falling freely, looking down: h0 - g t²/2, sampled at 100 Hz and seen 5 ms later.
TEST(DistanceSensor, RidesOnItsBodyAndDoesNotSeeIt) {
  WorldBench bench(R"(
engine: impulse
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: box, mass: 1, pose: {xyz: [0, 0, 5]}, shapes: [{box: [0.2, 0.2, 0.2]}]}
sensors:
  - {name: eye, kind: distance, body: box, range: [0.1, 20], rate_hz: 100, latency_ms: 5,
     pose: {xyz: [0, 0, 0.05], rpy: [0, 1.5707963267948966, 0]}}
)");
  bench.run(300);
  const double t = 0.29;
  EXPECT_EQ(bench.port("eye", "Changed"), 29.0);
  EXPECT_NEAR(bench.port("eye", "Distance"), 5.05 - 0.5 * 9.81 * t * t, 1e-9);
}

TEST(DistanceSensor, OnALinkThatWasJoinedIntoAnother) {
  const visum::test::TempFiles files;
  files.write("post.urdf", R"(<robot name="post">
  <link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="head"/>
  <joint name="neck" type="fixed"><parent link="base"/><child link="head"/><origin xyz="0.5 0 1"/></joint>
</robot>)");
  cycle::Simulation simulation(scene::load_scene(files.write("world.yaml", R"(visum: 1
models: [{name: post, file: post.urdf}]
bodies: [{name: wall, fixed: true, pose: {xyz: [3, 0, 0]}, shapes: [{box: [0.2, 9, 9]}]}]
sensors: [{name: eye, kind: distance, body: post/head, range: [0, 9]}]
)")));
  simulation.tick();
  EXPECT_NEAR(simulation.parts()[0].sensor_outputs[0], 3.0 - 0.1 - 0.5, 1e-12);
}

TEST(Scanner, MeasuresAWallRayByRay) {
  WorldBench bench(kWall +
                   "sensors: [{name: scan, kind: scanner, range: [0.1, 50], rays: 181, angle: [-1, 1.8]}]\n");
  bench.run(1);
  const auto bytes = bench.part("scan").part->read_blackboard(0);
  ASSERT_EQ(bytes.size(), 181 * sizeof(float));
  std::vector<float> scan(181);
  std::memcpy(scan.data(), bytes.data(), bytes.size());
  double nearest = 1e9;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const double angle = -1.0 + 2.8 * static_cast<double>(i) / 180.0;
    EXPECT_NEAR(scan[i], to_wall(angle), 1e-6 * to_wall(angle)) << angle;
    nearest = std::min(nearest, to_wall(angle));
  }
  EXPECT_NEAR(bench.port("scan", "Nearest Distance"), nearest, 1e-12);
  EXPECT_NEAR(bench.port("scan", "Nearest Angle"), 0.4, 2.8 / 180.0);
  EXPECT_EQ(bench.port("scan", "Rays In Range"), 181.0);
}

TEST(Scanner, ASilentOneKeepsItsScan) {
  WorldBench bench(R"(
gravity: [0, 0, 0]
bodies: [{name: ball, mass: 1, pose: {xyz: [3, 0, 0]}, velocity: {linear: [1, 0, 0]}, shapes: [{sphere: 0.3}]}]
sensors: [{name: scan, kind: scanner, range: [0.1, 50], rays: 3, angle: [-1, 1]}]
)");
  const auto scan = [&] {
    const auto bytes = bench.part("scan").part->read_blackboard(0);
    return std::vector(bytes.begin(), bytes.end());
  };
  bench.run(10);
  const auto before = scan();
  ASSERT_TRUE(bench.simulation.inject({0, {hwparts::FaultKind::kPartSilent, {}}, 20}).done());
  bench.run(10);
  EXPECT_EQ(scan(), before);
  bench.run(1);
  EXPECT_NE(scan(), before);
}

}  // namespace
}  // namespace visum::sensing
