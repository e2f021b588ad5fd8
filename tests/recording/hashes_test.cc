// Most ticks of a recording have no hash: how far a replay compares the whole state, and what it does where
// it cannot.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "server/recording/replay.h"
#include "tests/recording/forge.h"
#include "tests/recording/messages.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

// A ball that another force pushes than the one that was recorded, where no port shows it.
std::filesystem::path forged_push(RecordedWorld& world, int ticks, bool in_good_order) {
  EXPECT_TRUE(world->add_body(kBall).done());
  world.run(10);
  const auto ball = world->model().find_body("ball");
  EXPECT_TRUE(world->push({{ball, {0.0, 0.1, 0.0}, {0.0, 0.0, 0.0}}, 15}).done());
  world.run(ticks - 10);
  const auto forged = world.files().folder() / "forged.mcap";
  forge(world.finish(in_good_order), forged, "/inputs", 1, [&](std::vector<std::byte>& data) {
    data.clear();
    encode(TimedInput{10, 1, PushBody{static_cast<std::int32_t>(ball.value), {0.0, 0.2, 0.0}, {}, 15}}, data);
  });
  return forged;
}

// Ports tell the tick where the recording has no hash.
TEST(Hashes, ReplayShowsTheFirstTickWhosePortsDifferWhereItHasNone) {
  RecordedWorld world;
  world.run(30);
  world->write_inputs(0, 0, std::vector{0.1, 0.1});
  world.run(30);
  const auto forged = world.files().folder() / "forged.mcap";
  forge(world.finish(), forged, "/inputs", 0, [](std::vector<std::byte>& data) {
    data.clear();
    const std::vector values{0.1, 0.1000001};
    encode(TimedInput{30, 1, WriteInputs{"robot", 0, values}}, data);
  });
  const auto result = replay(forged);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.difference.tick, 31);
  EXPECT_EQ(result.difference.what, "ports are others");
  EXPECT_EQ(result.difference.recorded_hash, kNoHash);
  ASSERT_FALSE(result.difference.ports.empty());
  EXPECT_EQ(result.difference.ports[0].port, "Desired Angle 2");
}

TEST(Hashes, ReplayFindsAtTheNextHashWhatNoPortShows) {
  RecordedWorld world;
  const auto result = replay(forged_push(world, 60, true));
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.difference.what, "the state is another one");
  EXPECT_EQ(result.difference.tick, 51) << "the first tick has a hash, and every 50th after it";
  EXPECT_NE(result.difference.recorded_hash, kNoHash);
  EXPECT_NE(result.difference.recorded_hash, result.difference.replayed_hash);
  EXPECT_TRUE(result.difference.ports.empty());
  EXPECT_EQ(result.ticks, 50u);
  EXPECT_EQ(result.ticks_to_hash, 1u);
}

// Its last ticks have no hash, but there is the whole state behind them.
TEST(Hashes, ReplayFindsAtTheEndWhatNoPortShows) {
  RecordedWorld world;
  const auto result = replay(forged_push(world, 30, true));
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.difference.what, "the whole state is another one");
  EXPECT_NE(result.difference.recorded_hash, kNoHash);
  EXPECT_NE(result.difference.recorded_hash, result.difference.replayed_hash);
  EXPECT_EQ(result.ticks, 30u);
}

TEST(Hashes, ReplayTellsHowFarTheWholeStateWasCompared) {
  RecordedWorld world, cut;
  world.run(130);
  const auto whole = replay(world.finish());
  EXPECT_EQ(whole.ticks, 130u);
  EXPECT_EQ(whole.ticks_to_hash, 130u);
  cut.run(130);
  const auto part = replay(cut.finish(false));
  EXPECT_TRUE(part.equal);
  EXPECT_EQ(part.ticks, 130u);
  EXPECT_EQ(part.ticks_to_hash, 101u);
}

// Hashes are counted by the ticks of the recording: those of the world go back with each restore.
TEST(Hashes, AreFoundWhereTheWorldIsRestoredAgainAndAgain) {
  RecordedWorld world;
  world.run(10);
  const auto snapshot = world->take_snapshot();
  for (int i = 0; i < 8; ++i) {
    world.run(30);
    ASSERT_TRUE(world->restore_snapshot(snapshot).done());
  }
  world.run(20);
  const auto result = replay(world.finish(false));
  EXPECT_TRUE(result.equal);
  EXPECT_EQ(result.ticks, 270u);
  EXPECT_EQ(result.ticks_to_hash, 251u);
}

TEST(Hashes, TheLastIsThatOfTheLastTickWhateverComesAfterIt) {
  RecordedWorld world;
  world.run(30);
  const auto hash = world->state_hash();
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  EXPECT_NE(world->state_hash(), hash);
  const auto result = replay(world.finish());
  EXPECT_TRUE(result.equal);
  EXPECT_EQ(result.ticks_to_hash, 30u);
  EXPECT_EQ(result.last_hash, hash);
}

TEST(Hashes, ARecordingInWhichNothingHappenedHasNoState) {
  RecordedWorld world;
  EXPECT_TRUE(messages_of(world.finish(), "/states").empty());
  const auto result = replay(world.file());
  EXPECT_TRUE(result.equal);
  EXPECT_EQ(result.ticks, 0u);
}

TEST(Hashes, ReplayTellsTheRecordedHashOfATickThatFrozeThereOnly) {
  RecordedWorld world;
  world.run(1);
  const auto hash = world->state_hash();
  const auto forged = world.files().folder() / "forged.mcap";
  forge(world.finish(), forged, "/ticks", 0, [&](std::vector<std::byte>& data) {
    data.clear();
    encode(Tick{1, 1, 1'000'000, hash, "it flew away"}, data);
  });
  const auto result = replay(forged);
  EXPECT_FALSE(result.equal);
  EXPECT_NE(result.difference.what.find("it flew away"), std::string::npos) << result.difference.what;
  EXPECT_EQ(result.difference.recorded_hash, hash);
}

// Without a hash, ports are all that a tick is compared by.
TEST(Hashes, ATickWithNeitherHashNorPortsIsNoEqualOne) {
  RecordedWorld world;
  world.run(30);
  const auto forged = world.files().folder() / "forged.mcap";
  forge(
      world.finish(), forged, "", 0, [](std::vector<std::byte>&) {},
      [](std::string_view topic) { return topic != "/parts/robot"; });
  const auto result = replay(forged);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.difference.what, "the recording has not all ports of 'robot'");
  EXPECT_EQ(result.ticks, 1u) << "the first one has a hash";
}

// The world is right in its ports at that time, but the next hash shows another ball.
TEST(Hashes, RewindGoesOnToTheNextHashBeforeItTrustsTheTicksBefore) {
  RecordedWorld world;
  const auto forged = forged_push(world, 60, true);
  const auto rewinds = [&](double at_s) {
    try {
      return rewind(forged, at_s, {}).world->tick_count() == std::int64_t(std::lround(at_s * 1000));
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      EXPECT_NE(what.find("not the same bits at tick 51"), std::string::npos) << what;
      EXPECT_NE(what.find("up to 0.001 s"), std::string::npos) << what;
      return false;
    }
  };
  EXPECT_TRUE(rewinds(0.001));
  EXPECT_FALSE(rewinds(0.03));
}

}  // namespace
}  // namespace visum::recording
