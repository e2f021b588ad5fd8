#include "server/gateway/leases.h"

#include <gtest/gtest.h>

namespace visum::gateway {
namespace {

TEST(Leases, AreHeldByOneSession) {
  Leases leases(2);
  EXPECT_EQ(leases.of(0).session, 0u);
  leases.grant(0, 7, "seven");
  EXPECT_TRUE(leases.held_by(0, 7));
  EXPECT_FALSE(leases.held_by(0, 8));
  EXPECT_FALSE(leases.held_by(1, 7));
  EXPECT_EQ(leases.of(0).owner, "seven");
}

TEST(Leases, CountTheirGrants) {
  Leases leases(1);
  EXPECT_EQ(leases.grant(0, 7, "a"), 1u);
  leases.free(0);
  EXPECT_EQ(leases.of(0).session, 0u);
  EXPECT_EQ(leases.grant(0, 8, "b"), 2u);
}

TEST(Leases, TakeOnlyNewerSequenceNumbers) {
  Leases leases(1);
  leases.grant(0, 7, "a");
  EXPECT_TRUE(leases.is_new(0, 0)) << "0 is not counted";
  EXPECT_TRUE(leases.is_new(0, 5));
  leases.take_sequence(0, 5);
  leases.take_sequence(0, 0);
  EXPECT_FALSE(leases.is_new(0, 5));
  EXPECT_FALSE(leases.is_new(0, 4));
  EXPECT_TRUE(leases.is_new(0, 0));
  EXPECT_TRUE(leases.is_new(0, 6));
  leases.grant(0, 8, "b");
  EXPECT_TRUE(leases.is_new(0, 1)) << "the next owner counts anew";
}

}  // namespace
}  // namespace visum::gateway
