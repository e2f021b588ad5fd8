#include "protocol/busy_wait.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <chrono>
#include <thread>

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;

// Looks in vain. Returns how often.
int looks_in_vain(BusyWait& wait, std::chrono::nanoseconds at_most = milliseconds(100)) {
  int looks = 0;
  EXPECT_FALSE(wait.find([&] { return ++looks < 0; }, at_most));
  return looks;
}

// Finds at the second look, if it looks. Others run for `others_run` in between.
bool found_at_second_look(BusyWait& wait, milliseconds others_run) {
  int looks = 0;
  return wait.find([&] { return ++looks > 1; }, milliseconds(100),
                   [&] { std::this_thread::sleep_for(others_run); });
}

bool has_processors() {
  cpu_set_t allowed;
  return ::sched_getaffinity(0, sizeof allowed, &allowed) == 0 && CPU_COUNT(&allowed) > 1;
}

TEST(BusyWait, FindsWhatIsThere) {
  if (!has_processors()) GTEST_SKIP() << "one processor";
  BusyWait wait;
  int looks = 0;
  EXPECT_TRUE(wait.find([&] { return ++looks > 0; }, milliseconds(100)));
  EXPECT_EQ(looks, 1);
}

TEST(BusyWait, EndsByItself) {
  BusyWait wait;
  const auto begin = std::chrono::steady_clock::now();
  looks_in_vain(wait, std::chrono::hours(1));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

TEST(BusyWait, LooksEverMoreSeldomInVain) {
  if (!has_processors()) GTEST_SKIP() << "one processor";
  BusyWait wait;
  int waits_with_a_look = 0;
  for (int i = 0; i < 10'000; ++i) waits_with_a_look += looks_in_vain(wait) > 0;
  EXPECT_GT(waits_with_a_look, 500);  // it does not give up for good
  EXPECT_LT(waits_with_a_look, 700);
}

TEST(BusyWait, AThreadThatIsAlwaysPushedOutLooksSeldom) {
  if (!has_processors()) GTEST_SKIP() << "one processor";
  BusyWait wait;
  int finds = 0;
  for (int i = 0; i < 2000; ++i) finds += found_at_second_look(wait, milliseconds(1));
  EXPECT_GT(finds, 50);  // after another thread ran it looks once more
  EXPECT_LT(finds, 150);
}

TEST(BusyWait, ALookThatIsLongWorkIsNoDoubt) {
  if (!has_processors()) GTEST_SKIP() << "one processor";
  BusyWait wait;
  for (int i = 0; i < 100; ++i)
    EXPECT_TRUE(wait.find(
        [] {
          std::this_thread::sleep_for(milliseconds(1));
          return true;
        },
        milliseconds(100)));
}

TEST(BusyWait, AnInterruptionNowAndThenIsForgotten) {
  if (!has_processors()) GTEST_SKIP() << "one processor";
  BusyWait wait;
  int finds = 0;
  for (int i = 0; i < 2000; ++i)
    finds += found_at_second_look(wait, i % 50 == 0 ? milliseconds(1) : milliseconds(0));
  EXPECT_GT(finds, 1000);
}

TEST(BusyWait, WithOneProcessorItSleepsAtOnce) {
  std::thread([] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(::sched_getcpu()), &one);
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
    BusyWait wait;
    EXPECT_EQ(looks_in_vain(wait), 0);
  }).join();
}

}  // namespace
}  // namespace visum::protocol
