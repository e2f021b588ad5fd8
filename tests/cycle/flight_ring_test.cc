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
