// A few storms, each twice; session_storm runs more of them, and single ones.
#include <gtest/gtest.h>

#include "tests/gateway/storm/full_disk.h"
#include "tests/gateway/storm/storm.h"

namespace visum::storm {
namespace {

TEST(Storm, TheSameSeedIsTheSameStorm) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto once = run_storm(seed, 3000);
    const auto again = run_storm(seed, 3000);
    EXPECT_EQ(once.broken, "") << "seed " << seed;
    EXPECT_EQ(once.digest, again.digest) << "seed " << seed;
    EXPECT_NE(once.digest, run_storm(seed + 100, 3000).digest);
  }
}

TEST(Storm, IsOneWithWritesLossesAndRefusals) {
  Outcome all;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto outcome = run_storm(seed, 3000);
    EXPECT_EQ(outcome.broken, "") << "seed " << seed;
    all.ticks += outcome.ticks;
    all.servers += outcome.servers;
    all.counts.taken += outcome.counts.taken;
    all.counts.losses += outcome.counts.losses;
    all.counts.refused += outcome.counts.refused;
  }
  EXPECT_GT(all.ticks, 4000);
  EXPECT_GT(all.counts.taken, 100u);
  EXPECT_GT(all.counts.losses, 20u);
  EXPECT_GT(all.counts.refused, 100u);
}

TEST(Storm, ADiskThatFillsIsNoConcernOfTheSessions) {
  const FullDisk disk;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto without = run_storm(seed, 3000);
    const auto full = run_storm(seed, 3000, disk.file());
    EXPECT_TRUE(disk.is_full()) << "seed " << seed;
    EXPECT_EQ(full.broken, "") << "seed " << seed;
    EXPECT_EQ(full.digest, without.digest) << "seed " << seed;
  }
}

}  // namespace
}  // namespace visum::storm
