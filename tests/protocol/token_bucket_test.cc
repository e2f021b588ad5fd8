#include "protocol/token_bucket.h"

#include <gtest/gtest.h>

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;

TEST(TokenBucket, AllowsABurstOfOneSecondThenTheRate) {
  TokenBucket::Time now{};
  TokenBucket bucket(10.0, now);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(bucket.take(now));
  EXPECT_FALSE(bucket.take(now));
  now += milliseconds(99);
  EXPECT_FALSE(bucket.take(now));
  now += milliseconds(1) + std::chrono::microseconds(1);
  EXPECT_TRUE(bucket.take(now));
  EXPECT_FALSE(bucket.take(now));
}

TEST(TokenBucket, AfterTheWaitThereIsAToken) {
  TokenBucket::Time now{};
  TokenBucket bucket(3.0, now);
  while (bucket.take(now)) {
  }
  now += bucket.wait();
  EXPECT_TRUE(bucket.take(now));
}

TEST(TokenBucket, DoesNotSaveUpMoreThanASecond) {
  TokenBucket::Time now{};
  TokenBucket bucket(5.0, now);
  now += std::chrono::hours(1);
  int taken = 0;
  while (bucket.take(now)) ++taken;
  EXPECT_EQ(taken, 5);
}

}  // namespace
}  // namespace visum::protocol
