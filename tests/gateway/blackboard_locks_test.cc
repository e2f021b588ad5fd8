// Pieces that wait under a lock of a blackboard have a limit.
#include "server/gateway/blackboard_locks.h"

#include <gtest/gtest.h>

namespace visum::gateway {
namespace {

TEST(BlackboardLocks, EmptyWritesUnderOneHaveALimit) {
  BlackboardLocks locks;
  const Published now;
  ASSERT_FALSE(locks.lock(1, {"arm", "Trajectory", 1'000'000}, 1000, now));
  BlackboardLocks::Refusal refusal;
  std::size_t kept = 0;
  const std::size_t most = BlackboardLocks::kMostBytes / sizeof(protocol::WriteBlackboard);
  while (!refusal && kept <= most && locks.keep(1, {"arm", "Trajectory"}, now, refusal)) ++kept;
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->first, protocol::ErrorCode::kBusy);
  EXPECT_GT(kept, 1000u);
}

}  // namespace
}  // namespace visum::gateway
