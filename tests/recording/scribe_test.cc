// The thread that writes: what it is given is in the file, and a disk that fails ends the recording alone.
#include "server/recording/scribe.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "server/recording/replay.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

TEST(Scribe, AFileThatCannotBeMadeIsAnError) {
  EXPECT_THROW(Scribe("/nowhere/at/all.mcap", Scribe::Overflow::kWait), std::runtime_error);
}

TEST(Scribe, AFullDiskEndsTheRecordingAndNothingElse) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(Scribe("/dev/full", Scribe::Overflow::kWait), std::runtime_error) << "already the first byte";
}

// No file of this process may grow beyond `bytes` while the object lives; writing more is an error, as on a
// full disk.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  sighandler_t handler_;
  rlimit before_{};
};

TEST(Recorder, ADiskThatFillsEndsTheRecordingAndTheTicksGoOn) {
  RecordedWorld world("amtec_arm.yaml");
  {
    const SmallDisk disk(2 << 20);
    world.run(6000);
    world.finish();
  }
  EXPECT_EQ(world->tick_count(), 6000);
  const auto result = replay(world.file());
  EXPECT_TRUE(result.equal);
  EXPECT_GT(result.ticks, 100u);
  EXPECT_LT(result.ticks, 6000u);
  EXPECT_NE(result.damage, "");
}

TEST(Scribe, WhatWaitsIsBoundedAndARealtimeWorldNeverWaits) {
  test::TempFiles files;
  Scribe scribe(files.folder() / "slow.mcap", Scribe::Overflow::kEnd);
  const auto channel = scribe.writer().add_channel("/x", 0, "");
  const std::vector<std::byte> big(1 << 20);
  for (int i = 0; i < 40 && !scribe.ended(); ++i) scribe.put(channel, 0, 0, big);  // nobody writes yet
  EXPECT_TRUE(scribe.ended());
}

TEST(Recorder, GoesOnTickingWhereTheRecordingEnded) {
  RecordedWorld world;
  world.run(10);
  world.recorder().log("info", "a line");
  world.finish();
  world.run(10);
  EXPECT_EQ(world->tick_count(), 20);
  EXPECT_EQ(replay(world.file()).ticks, 10u);
}

}  // namespace
}  // namespace visum::recording
