#include "clients/visum/run/wait_loop.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "clients/visum/common/exit_code.h"

namespace visum::run {
namespace {

using std::chrono::milliseconds;

TEST(WaitLoop, EndsWhenTheDescriptorCanBeRead) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "x", 1), 1);
  WaitLoop wait_loop(60.0);
  EXPECT_TRUE(wait_loop.wait(ends[0], milliseconds(60'000)));
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(WaitLoop, EndsWhenThePatienceIsOver) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  WaitLoop wait_loop(60.0);
  EXPECT_FALSE(wait_loop.wait(ends[0], milliseconds(1)));
  EXPECT_FALSE(wait_loop.wait(-1, milliseconds(1)));
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(WaitLoop, ThrowsWhenTheWallTimeIsOver) {
  WaitLoop wait_loop(0.001);
  try {
    while (true) wait_loop.wait(-1, milliseconds(1));
  } catch (const cli::ExitError& error) {
    EXPECT_EQ(error.code(), cli::kTimedOut);
    EXPECT_STREQ(error.what(), "not done after 0.001 s of wall time");
  }
}

TEST(WaitLoop, KeepsAChildThatPrintsMuchFromBlocking) {
  std::size_t lines = 0;
  processes::ChildProcess child("c", {"/bin/sh", "-c", "yes | head -n 200000; echo done"},
                                [&](const std::string&) { ++lines; }, {});
  WaitLoop wait_loop(60.0);
  wait_loop.watch(child);
  while (!child.check_exit()) wait_loop.wait(-1, milliseconds(10));
  EXPECT_EQ(lines, 200'001u);
  wait_loop.forget(child);
}

}  // namespace
}  // namespace visum::run
