#include "server/cycle/network_model.h"

#include <gtest/gtest.h>

namespace visum::cycle {
namespace {

NetworkModel::Quality quality(double ms, double jitter_ms) {
  const hwparts::ActiveFault late{0, {hwparts::FaultKind::kNetworkDelay, {ms, jitter_ms}}, 0};
  return NetworkModel::quality_of({&late, 1}, 1'000'000);
}

TEST(NetworkModel, ADelayIsWholeTicksAndNeverNone) {
  EXPECT_EQ(quality(25.0, 3.0).delay_ticks, 25);
  EXPECT_EQ(quality(25.0, 3.0).jitter_ticks, 3);
  EXPECT_EQ(quality(2.4, 0.0).delay_ticks, 2);
  EXPECT_EQ(quality(0.3, 0.2).delay_ticks, 1);
  EXPECT_EQ(quality(0.3, 0.2).jitter_ticks, 1);
  EXPECT_EQ(quality(0.0, 0.0), NetworkModel::Quality{});
}

TEST(NetworkModel, HasRoomForTheLongestDelayAtUsualTicks) {
  protocol::PartDescription part{.name = "arm"};
  part.controller_inputs.resize(70);
  part.sensor_outputs.resize(400);
  const hwparts::Fault longest{hwparts::FaultKind::kNetworkDelay, {1000, 1000}};
  EXPECT_TRUE(NetworkModel::has_room_for(longest, part, 1'000'000).done());
  EXPECT_EQ(NetworkModel::has_room_for(longest, part, 10'000).refusal(), Refusal::kBadValue);
  EXPECT_EQ(NetworkModel::has_room_for(longest, part, 1).refusal(), Refusal::kBadValue);
  EXPECT_TRUE(NetworkModel::has_room_for({hwparts::FaultKind::kNetworkLoss, {1.0}}, part, 1).done());
}

}  // namespace
}  // namespace visum::cycle
