#include "server/cycle/behind_watch.h"

#include <gtest/gtest.h>

#include <vector>

#include "server/cycle/pacer.h"

namespace visum::cycle {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A world with a tick each 10 ms, some of which come too late.
class Late : public testing::Test {
 protected:
  // Lets time pass; each second `lost` of it is dropped.
  void run(seconds time, milliseconds lost) {
    for (int second = 0; second < time.count(); ++second) {
      lost_ += lost;
      overruns_ += lost.count() > 0;
      for (int tick = 0; tick < 100; ++tick) {
        now_ += milliseconds(10);
        if (const auto line = watch_.look(now_, lost_, overruns_)) lines_.push_back(*line);
      }
    }
  }

  BehindWatch watch_;
  BehindWatch::Clock::time_point now_{};
  std::chrono::nanoseconds lost_{0};
  std::uint64_t overruns_ = 0;
  std::vector<std::string> lines_;
};

TEST_F(Late, AWorldThatKeepsUpIsNotMentioned) {
  run(seconds(200), milliseconds(9));
  EXPECT_TRUE(lines_.empty());
}

TEST_F(Late, IsToldWithinTwoSecondsAndThenOnceAMinute) {
  run(seconds(2), milliseconds(300));
  ASSERT_EQ(lines_.size(), 1u);
  EXPECT_EQ(lines_[0].find("the world falls behind the wall clock: "), 0u) << lines_[0];
  run(seconds(178), milliseconds(300));
  EXPECT_EQ(lines_.size(), 3u);
  EXPECT_NE(lines_[1].find("60 ticks came too late, and 18.000 s were lost"), std::string::npos) << lines_[1];
}

TEST_F(Late, RecoveryIsToldOnce) {
  run(seconds(5), milliseconds(300));
  run(seconds(100), milliseconds(0));
  ASSERT_EQ(lines_.size(), 2u);
  EXPECT_EQ(lines_[1].find("the world keeps up with the wall clock again: "), 0u) << lines_[1];
}

TEST_F(Late, AWorldThatIsLateNowAndThenWritesTwoLinesAMinuteAtMost) {
  for (int i = 0; i < 25; ++i) {
    run(seconds(1), milliseconds(300));
    run(seconds(11), milliseconds(0));
  }
  EXPECT_LE(lines_.size(), 10u) << "in five minutes";
  EXPECT_GE(lines_.size(), 5u);
}

TEST(Pacer, SaysHowMuchTimeItDropped) {
  Pacer pacer(1'000'000);
  Pacer::Clock::time_point now{};
  pacer.restart(now);
  pacer.begin_tick(now + milliseconds(1));
  EXPECT_EQ(pacer.lost(), milliseconds(0));
  pacer.begin_tick(now + milliseconds(7));  // was due at 2 ms
  EXPECT_EQ(pacer.lost(), milliseconds(5));
  pacer.restart(now + seconds(10));
  pacer.begin_tick(now + seconds(10) + milliseconds(1));
  EXPECT_EQ(pacer.lost(), milliseconds(5)) << "a pause is no loss";
}

}  // namespace
}  // namespace visum::cycle
