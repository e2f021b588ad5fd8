// Ticks with sensors of every kind. What Embree and the engines allocate inside is counted apart.
#include <gtest/gtest.h>

#include "tests/sensing/world_bench.h"
#include "tests/support/allocation_counter.h"

namespace visum::sensing {
namespace {

TEST(Senses, AllocateNothingOfOursOnceWarm) {
  test::WorldBench bench(R"(
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true}]}
  - {name: ball, mass: 1, pose: {xyz: [0, 0, 1]}, velocity: {linear: [1, 0, 0]}, shapes: [{sphere: 0.1}]}
  - {name: arm, mass: 1, pose: {xyz: [0, 2, 2]}, shapes: [{capsule: {radius: 0.1, length: 1}}]}
joints: [{name: hinge, type: hinge, child: arm, axis: [1, 0, 0], pose: {xyz: [0, 2, 2.5]}, position: 1}]
sensors:
  - {name: eye, kind: distance, range: [0.01, 9], body: ball, noise: 0.01}
  - {name: fan, kind: scanner, range: [0.01, 9], rays: 21, angle: [-1, 1], body: arm, latency_ms: 3, noise: 0.01}
  - {name: imu, kind: imu, body: ball, gyro: {noise: 0.1, bias: 0.1}}
  - {name: tracker, kind: pose, body: ball, position: {noise: 0.1}, orientation: {noise: 0.1}}
  - {name: bumper, kind: contact, body: ball}
  - {name: cell, kind: joint_wrench, joint: hinge, torque: {noise: 0.1}}
)");
  bench.run(1000);
  test_support::AllocationCounts counts;
  std::string ours;
  {
    const test_support::AllocationScope scope;
    bench.run(500);
    counts = scope.counts();
    ours = scope.describe_ours();
  }
  EXPECT_EQ(counts.ours, 0u) << ours;
  EXPECT_EQ(bench.port("fan", "Changed"), 1497.0);
}

}  // namespace
}  // namespace visum::sensing
