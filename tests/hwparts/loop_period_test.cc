// A servo loop with a period of its own: what the drive does no longer depends on the tick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

// Where the rotor is, every 4 ms of a step by 0.3 rad.
std::vector<double> way(double tick_s, double period_s) {
  auto data = ideal(arm_drive(5));
  data.gear.viscous_friction = 20.0;
  data.loop.period = period_s;
  data.loop.speed_filter = 0.004;
  data.loop.velocity_bandwidth = 190.0;  // near the bound of a loop of 4 ms
  Rig rig(data, tick_s);
  rig.plants[0].inertia = 2.0;
  rig.command.target = 0.3;
  std::vector<double> positions;
  for (int k = 0; k < 500; ++k) {
    rig.run(0.004);
    positions.push_back(rig.state().rotor_position);
  }
  return positions;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

TEST(LoopPeriod, DecidesTheMotionAndTheTickDoesNot) {
  const auto fine = way(0.0001, 0.004);
  const double coarse_tick = distance(way(0.001, 0.004), fine);
  const double other_loop = distance(way(0.0001, 0.0001), fine);
  EXPECT_LT(coarse_tick, 0.01 * other_loop);
  // By first order (0.5 - 0.1) / (1 - 0.1) = 0.44 of it is left.
  EXPECT_LT(distance(way(0.0005, 0.004), fine), 0.5 * coarse_tick) << "it converges with the tick";
}

TEST(LoopPeriod, OfOneTickIsTheLoopOfEachTick) {
  EXPECT_EQ(way(0.001, 0.001), way(0.001, 0.0));
}

TEST(LoopPeriod, HoldsTheCurrentInBetween) {
  auto data = ideal(arm_drive(5));
  data.loop.period = 0.005;
  Rig rig(data);
  rig.plants[0].inertia = 2.0;
  rig.command.target = 0.3;
  rig.run(0.1);
  int changes = 0;
  double before = rig.state().current, speed = rig.state().measured_speed;
  int speeds = 0;
  for (int k = 0; k < 100; ++k) {
    rig.tick();
    changes += rig.state().current != before;
    speeds += rig.state().measured_speed != speed;
    before = rig.state().current;
    speed = rig.state().measured_speed;
  }
  EXPECT_EQ(changes, 20);
  EXPECT_EQ(speeds, 20);
}

// The supply and a commanded current take effect at once: the power stage waits for no loop.
TEST(LoopPeriod, DelaysNoCommandedCurrent) {
  auto data = ideal(arm_drive(5));
  data.loop.period = 0.02;
  Rig rig(data);
  rig.run(0.003);
  rig.drive.move_by_bus({.kind = drive::MotionKind::kCurrent, .target = 0.5});
  rig.tick();
  EXPECT_EQ(rig.state().current, 0.5);
  rig.supply(0.0);
  rig.tick();
  rig.tick();
  EXPECT_EQ(rig.state().current, 0.0);
}

// A jump of the encoder's zero is no motion, also between two runs of the loop.
TEST(LoopPeriod, SeesNoSpeedWhereTheZeroMoves) {
  auto data = ideal(arm_drive(5));
  data.loop.period = 0.01;
  Rig rig(data);
  rig.run(0.1);
  rig.run(0.003);
  rig.drive.set_home_offset(0.5);
  rig.drive.apply_home_offset();
  for (int k = 0; k < 30; ++k) {
    rig.tick();
    EXPECT_LT(std::abs(rig.state().measured_speed), 1e-3) << k;
  }
  EXPECT_NEAR(rig.state().measured_position, 0.5, 1e-5);
}

}  // namespace
}  // namespace visum::test
