// The writer's thread: the file holds what it was given, and a disk that fails ends only the recording.
#include "server/recording/recording_writer.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "server/recording/replay.h"
#include "tests/recording/messages.h"
#include "tests/recording/recorded_world.h"
#include "tests/recording/small_disk.h"

namespace visum::recording {
namespace {

TEST(RecordingWriter, AFileThatCannotBeMadeIsAnError) {
  EXPECT_THROW(RecordingWriter("/nowhere/at/all.mcap", RecordingWriter::Overflow::kWait), std::runtime_error);
}

TEST(RecordingWriter, AFullDiskEndsTheRecordingAndNothingElse) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(RecordingWriter("/dev/full", RecordingWriter::Overflow::kWait), std::runtime_error)
      << "already the first byte";
}

TEST(Recorder, ADiskThatFillsEndsTheRecordingAndTheTicksGoOn) {
  RecordedWorld world("amtec_arm.yaml");
  {
    const SmallDisk disk(1 << 19);
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

TEST(RecordingWriter, WhatWaitsIsBoundedAndARealtimeWorldNeverWaits) {
  test::TempFiles files;
  RecordingWriter writer(files.folder() / "slow.mcap", RecordingWriter::Overflow::kEnd);
  const auto channel = writer.writer().add_channel("/x", 0, "");
  const std::vector<std::byte> big(1 << 20);
  for (int i = 0; i < 40 && !writer.ended(); ++i) writer.put(channel, 0, 0, big);  // nobody writes yet
  EXPECT_TRUE(writer.ended());
}

// The tick's thread, too, may be the one that cannot go on.
TEST(RecordingWriter, ARecordingThatEndedEarlyIsToldToBeCut) {
  const test::TempFiles files;
  for (const bool early : {true, false}) {
    const auto file = files.folder() / "run.mcap";
    {
      RecordingWriter writer(file, RecordingWriter::Overflow::kWait);
      const auto channel = writer.writer().add_channel("/x", 0, "");
      writer.start();
      writer.put(channel, 1, 1, {});
      if (early) writer.end("no more can be put");
      writer.put(channel, 2, 2, {});
      EXPECT_EQ(writer.close(), !early);
    }
    EXPECT_EQ(messages_of(file, "/x").size(), early ? 1u : 2u);
    std::ifstream in(file, std::ios::binary);
    McapReader reader(in);
    while (!std::holds_alternative<McapReader::End>(reader.next())) {
    }
    EXPECT_EQ(reader.damage().find("its writer was cut short") != std::string::npos, early)
        << reader.damage();
  }
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

// Cameras with a long latency keep many readings, and each snapshot keeps as many again.
std::string much_to_keep() {
  return R"(
visum: 1
clock: lockstep
tick_ms: 50
bodies:
  - {name: "stone_${i}", repeat: {i: 100}, fixed: true, shapes: [{sphere: 0.1}], pose: {xyz: ["${i}", 0, 0]}}
sensors:
  - {name: "eye_${i}", repeat: {i: 4}, kind: camera, size: [1, 1], fov_deg: 60, latency_ms: 5000}
)";
}

// A state serves seeking only, unless the recording begins with it. It may be longer than the queue.
TEST(Recorder, AStateThatIsTooLongIsLeftOutAndTheRecordingGoesOn) {
  const test::TempFiles files;
  const auto first = files.folder() / "first.mcap", second = files.folder() / "second.mcap";
  config::FilesNoted noted;
  cycle::Simulation simulation(scene::load_scene(files.write("scene.yaml", much_to_keep())));
  {
    Recorder recorder(simulation, {noted.files, ""}, first);
    for (int i = 0; i < 110; ++i) simulation.tick();
    for (int i = 0; i < 16; ++i) simulation.take_snapshot();
    for (int i = 0; i < 30; ++i) simulation.tick();
  }
  State whole;
  simulation.keep(whole);
  std::vector<std::byte> bytes;
  encode(whole, bytes);
  ASSERT_GT(bytes.size(), RecordingWriter::kQueueBytes);
  auto [again, origin] = rewind(first, std::numeric_limits<double>::infinity(), {});
  EXPECT_EQ(again->tick_count(), 140);
  EXPECT_EQ(again->state_hash(), simulation.state_hash());
  {
    Recorder recorder(*again, origin, second);
    for (int i = 0; i < 10; ++i) again->tick();
    ASSERT_TRUE(again->restore_snapshot(16).done());
    again->tick();
  }
  const auto result = replay(second);
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_EQ(result.damage, "");
  EXPECT_EQ(result.ticks, 11u);
}

TEST(Recorder, EachMessageHasTheSimulatedTimeOfItsEra) {
  RecordedWorld world;
  world.run(5);
  world->write_inputs(0, 0, std::vector{0.7});
  world->reset();
  world.run(3);
  world->write_inputs(0, 0, std::vector{0.1});
  const auto inputs = messages_of(world.finish(), kInputTopic);
  ASSERT_EQ(inputs.size(), 3u);
  constexpr std::uint64_t kMs = 1'000'000;
  EXPECT_EQ(inputs[0].times_ns, std::pair(5 * kMs, 5 * kMs));
  EXPECT_EQ(inputs[1].times_ns, std::pair(5 * kMs, 5 * kMs)) << "the reset, in the era that it ended";
  EXPECT_EQ(inputs[2].times_ns, std::pair(8 * kMs, 3 * kMs));
}

TEST(RecordingWriter, ALineHasTheTimesOfTheMessageBeforeIt) {
  const test::TempFiles files;
  const auto file = files.folder() / "lines.mcap";
  {
    RecordingWriter writer(file, RecordingWriter::Overflow::kWait);
    const auto states = writer.writer().add_channel(kStateTopic, 0, "");
    const auto log = writer.writer().add_channel(kLogTopic, 0, "");
    writer.put_first(states, 700, {});
    writer.put_line(log, {});
    writer.start();
  }
  const auto lines = messages_of(file, kLogTopic);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].times_ns, std::pair(std::uint64_t{0}, std::uint64_t{700}));
}

}  // namespace
}  // namespace visum::recording
