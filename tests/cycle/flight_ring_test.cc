#include "server/cycle/flight_ring.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace visum::cycle {
namespace {

std::pair<double, double> peaks(const FlightRing& ring, std::int64_t after, std::int64_t until) {
  std::array<double, 1> errors{}, forces{};
  ring.peaks(after, until, errors, forces);
  return {errors[0], forces[0]};
}

void record(FlightRing& ring, std::int64_t tick, double error, double force) {
  ring.record(tick, std::vector{error}, std::vector{force});
}

TEST(FlightRing, KeepsThePeakBetweenTwoLooks) {
  FlightRing ring(1, 1);
  record(ring, 1, 0.1, 5.0);
  record(ring, 2, -0.7, 1.0);
  record(ring, 3, 0.2, 2.0);
  EXPECT_EQ(peaks(ring, 0, 3), std::pair(0.7, 5.0)) << "magnitudes count";
  EXPECT_EQ(peaks(ring, 2, 3), std::pair(0.2, 2.0)) << "the tick of the last look is not looked at again";
  EXPECT_EQ(peaks(ring, 3, 3), std::pair(0.0, 0.0));
}

TEST(FlightRing, ForgetsWhatIsOlderThanItsLength) {
  FlightRing ring(1, 1);
  record(ring, 1, 9.0, 9.0);
  for (std::int64_t tick = 2; tick <= FlightRing::kTicks + 1; ++tick) record(ring, tick, 1.0, 1.0);
  EXPECT_EQ(peaks(ring, 0, FlightRing::kTicks + 1), std::pair(1.0, 1.0));
}

TEST(FlightRing, HoldsFewerTicksOfALargeWorld) {
  EXPECT_EQ(FlightRing(30, 900).ticks(), FlightRing::kTicks);
  EXPECT_EQ(FlightRing(10'000, 10'000).ticks(), FlightRing::kLeastTicks);
  FlightRing ring(0, 10'000);
  EXPECT_EQ(ring.ticks(), 419);
  std::vector<double> forces(10'000, 1.0);
  forces.back() = 9.0;
  ring.record(1, {}, forces);
  const auto last_peak = [&](std::int64_t until) {
    ring.peaks(0, until, {}, forces);
    return forces.back();
  };
  const std::vector<double> others(10'000, 1.0);
  for (std::int64_t tick = 2; tick <= ring.ticks(); ++tick) ring.record(tick, {}, others);
  EXPECT_EQ(last_peak(ring.ticks()), 9.0);
  ring.record(ring.ticks() + 1, {}, others);
  EXPECT_EQ(last_peak(ring.ticks() + 1), 1.0);
}

TEST(FlightRing, TakesOverWhatBodiesThatStayHaveFelt) {
  FlightRing ring(1, 3), more(1, 4), fewer(1, 2);
  for (std::int64_t tick = 1; tick <= 20; ++tick)
    ring.record(tick, std::vector{0.5}, std::vector{tick == 7 ? 9.0 : 1.0, 2.0, 3.0});
  ring.begin(5);
  std::vector<double> errors(1), forces(4);
  const std::vector joint{world::JointId{0}};
  using Bodies = std::vector<world::BodyId>;
  more.take_over(ring, 20, joint, Bodies{{0}, {1}, {2}, {}});
  more.peaks(0, 20, errors, forces);
  EXPECT_EQ(errors, std::vector{0.5});
  EXPECT_EQ(forces, (std::vector{9.0, 2.0, 3.0, 0.0}));
  more.peaks(0, 5, errors, forces);
  EXPECT_EQ(forces, std::vector<double>(4)) << "of another era";
  forces.resize(2);
  fewer.take_over(ring, 20, joint, Bodies{{0}, {2}});
  fewer.peaks(6, 20, errors, forces);
  EXPECT_EQ(forces, (std::vector{9.0, 3.0}));
  fewer.peaks(7, 20, errors, forces);
  EXPECT_EQ(forces, (std::vector{1.0, 3.0}));
}

TEST(FlightRing, LooksAtNoTickBeforeItsEra) {
  FlightRing ring(1, 1);
  for (std::int64_t tick = 1; tick <= 20; ++tick) record(ring, tick, 9.0, 9.0);
  ring.begin(10);
  EXPECT_EQ(peaks(ring, 0, 10), std::pair(0.0, 0.0));
  record(ring, 11, 1.0, 2.0);
  EXPECT_EQ(peaks(ring, 0, 11), std::pair(1.0, 2.0));
}

}  // namespace
}  // namespace visum::cycle
