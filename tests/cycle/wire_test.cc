#include "server/cycle/wire.h"

#include <gtest/gtest.h>

namespace visum::cycle {
namespace {

Wire::Quality quality(double ms, double jitter_ms) {
  const hwparts::ActiveFault late{0, {hwparts::FaultKind::kNetworkDelay, {ms, jitter_ms}}, 0};
  return Wire::quality_of({&late, 1}, 1'000'000);
}

TEST(Wire, ADelayIsWholeTicksAndNeverNone) {
  EXPECT_EQ(quality(25.0, 3.0).delay_ticks, 25);
  EXPECT_EQ(quality(25.0, 3.0).jitter_ticks, 3);
  EXPECT_EQ(quality(2.4, 0.0).delay_ticks, 2);
  EXPECT_EQ(quality(0.3, 0.2).delay_ticks, 1);
  EXPECT_EQ(quality(0.3, 0.2).jitter_ticks, 1);
  EXPECT_EQ(quality(0.0, 0.0), Wire::Quality{});
}

}  // namespace
}  // namespace visum::cycle
