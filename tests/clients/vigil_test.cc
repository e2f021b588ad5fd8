#include "clients/visum/run/vigil.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "clients/visum/common/exit_code.h"

namespace visum::run {
namespace {

using std::chrono::milliseconds;

TEST(Vigil, EndsWhenTheDescriptorCanBeRead) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "x", 1), 1);
  Vigil vigil(60.0);
  EXPECT_TRUE(vigil.wait(ends[0], milliseconds(60'000)));
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(Vigil, EndsWhenThePatienceIsOver) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  Vigil vigil(60.0);
  EXPECT_FALSE(vigil.wait(ends[0], milliseconds(1)));
  EXPECT_FALSE(vigil.wait(-1, milliseconds(1)));
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(Vigil, ThrowsWhenTheWallTimeIsOver) {
  Vigil vigil(0.001);
  try {
    while (true) vigil.wait(-1, milliseconds(1));
  } catch (const cli::ExitError& error) {
    EXPECT_EQ(error.code(), cli::kTimedOut);
    EXPECT_STREQ(error.what(), "not done after 0.001 s of wall time");
  }
}

TEST(Vigil, KeepsAChildThatPrintsMuchFromBlocking) {
  std::size_t lines = 0;
  ChildProcess child("c", {"/bin/sh", "-c", "yes | head -n 200000; echo done"},
                     [&](const std::string&) { ++lines; }, {});
  Vigil vigil(60.0);
  vigil.watch(child);
  while (!child.check_exit()) vigil.wait(-1, milliseconds(10));
  EXPECT_EQ(lines, 200'001u);
  vigil.forget(child);
}

}  // namespace
}  // namespace visum::run
