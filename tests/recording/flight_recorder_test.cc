// A frozen world leaves a file that replays up to the freeze.
#include "server/recording/flight_recorder.h"

#include <gtest/gtest.h>

#include <optional>

#include "server/recording/player.h"
#include "server/recording/replay.h"
#include "server/scene/scene.h"
#include "tests/recording/forge.h"
#include "tests/recording/messages.h"
#include "tests/recording/small_disk.h"
#include "tests/support/temp_files.h"

namespace visum::recording {
namespace {

class Flight : public testing::Test {
 protected:
  Flight() {
    config::FilesNoted noted;
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
    simulation_.emplace(std::move(scene));
    flight_.emplace(*simulation_, Origin{std::move(noted.files), ""}, files_.folder() / "not" / "yet");
  }
  cycle::Simulation& world() { return *simulation_; }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) world().tick();
  }
  // A solver that explodes, as the world sees it.
  void explode() {
    EXPECT_TRUE(world()
                    .push({{world().model().find_body("robot/fore"), {1e12, 0, 0}, {0, 0, 0}},
                           world().tick_count() + 9})
                    .done());
    run(9);
    ASSERT_TRUE(world().frozen());
  }

  test::TempFiles files_;
  std::optional<cycle::Simulation> simulation_;
  std::optional<FlightRecorder> flight_;
};

TEST_F(Flight, AFrozenWorldLeavesItsLastThousandTicks) {
  for (int i = 0; i < 35; ++i) {
    world().write_inputs(0, 0, std::vector{0.01 * i, -0.3});
    run(100);
  }
  EXPECT_EQ(flight_->dump(), "");
  explode();
  ASSERT_NE(flight_->dump(), "");
  const auto result = replay(flight_->dump());
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_EQ(result.damage, "");
  EXPECT_EQ(result.ticks, 3500u - 2000u + 1u)
      << "the half before the last, the last, and the tick that froze";
  EXPECT_EQ(result.last_hash, world().state_hash());
}

// The file has no hash for most ticks, but it has all their ports.
TEST_F(Flight, EveryTickOfItIsCompared) {
  world().write_inputs(0, 0, std::vector{0.7, -0.3});
  run(1500);
  explode();
  const auto forged = files_.folder() / "forged.mcap";
  protocol::PartSample sample;
  forge(flight_->dump(), forged, "/parts/robot", 77, [&](std::vector<std::byte>& bytes) {
    ASSERT_TRUE(decode(bytes, sample));
    sample.sensor_outputs[0] += 1e-12;
    bytes.clear();
    encode(Sample{sample.part, sample.tick, sample.sim_time_ns, sample.era, sample.controller_inputs,
                  sample.sensor_outputs},
           bytes);
  });
  const auto result = replay(forged);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.ticks, 77u);
  ASSERT_EQ(result.difference.ports.size(), 1u);
  EXPECT_EQ(result.difference.ports[0].recorded, sample.sensor_outputs[0]);
}

TEST_F(Flight, ThePageShowsItFromItsFirstTickToTheFreeze) {
  run(2300);
  explode();
  Player player(flight_->dump(), {});
  EXPECT_EQ(player.world().tick_count(), 1000);
  EXPECT_EQ(player.ticks(), 1301u);
  player.seek(player.ticks());
  EXPECT_EQ(player.world().fault(), world().fault());
  player.seek(700);
  EXPECT_FALSE(player.world().frozen());
  EXPECT_EQ(player.world().tick_count(), 1700);
}

TEST_F(Flight, KnowsTheBodiesThatCameLongBefore) {
  EXPECT_TRUE(world()
                  .add_body("{name: ball, mass: 0.5, pose: {xyz: [0.6, 0.5, 1.0]}, shapes: [{sphere: 0.05}]}")
                  .done());
  run(2500);
  const auto snapshot = world().take_snapshot();
  run(1200);
  ASSERT_TRUE(world().restore_snapshot(snapshot).done());
  run(10);
  explode();
  const auto result = replay(flight_->dump());
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_GE(result.ticks, 1000u);
}

TEST_F(Flight, AWorldThatLivesAgainCanFreezeAgain) {
  run(50);
  explode();
  const auto first = flight_->dump();
  world().reset();
  EXPECT_EQ(flight_->dump(), "") << "it is not frozen any more";
  run(20);
  explode();
  EXPECT_NE(flight_->dump(), first);
  EXPECT_EQ(replay(flight_->dump()).ticks, 21u);
  EXPECT_EQ(replay(first).ticks, 51u);
}

// The second dump takes the scene's files from the first recording, whatever is on the disk by now.
TEST_F(Flight, AWorldThatWasRewoundLeavesItsLastTicks) {
  world().write_inputs(0, 0, std::vector{0.7, -0.3});
  run(500);
  explode();
  auto [again, origin] = rewind(flight_->dump(), 0.4, {});
  FlightRecorder second(*again, std::move(origin), files_.folder());
  again->write_inputs(0, 0, std::vector{0.2});
  for (int i = 0; i < 20; ++i) again->tick();
  EXPECT_TRUE(
      again
          ->push({{again->model().find_body("robot/fore"), {1e12, 0, 0}, {0, 0, 0}}, again->tick_count() + 9})
          .done());
  for (int i = 0; i < 9; ++i) again->tick();
  ASSERT_NE(second.dump(), "");
  const auto result = replay(second.dump());
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_EQ(result.ticks, 21u) << "from where it was put to where it froze";
  EXPECT_EQ(result.last_hash, again->state_hash());
}

// In a container each run has the same process number, and the same ticks, so names could clash.
TEST_F(Flight, ADumpTakesThePlaceOfNoOther) {
  const auto explode_anew = [&] {
    simulation_.emplace(
        scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml"));
    flight_.emplace(*simulation_, Origin{}, files_.folder());
    explode();
    return flight_->dump();
  };
  flight_.reset();
  const auto first = explode_anew();
  flight_.reset();
  const auto size = std::filesystem::file_size(first);
  const auto second = explode_anew();
  EXPECT_NE(second, first);
  EXPECT_EQ(std::filesystem::file_size(first), size);
  EXPECT_GT(std::filesystem::file_size(second), 0u);
}

TEST_F(Flight, NothingIsLeftOfADumpThatCannotBeWritten) {
  run(1000);
  {
    const SmallDisk disk(10'000);
    explode();
  }
  EXPECT_EQ(flight_->dump(), "");
  EXPECT_TRUE(std::filesystem::is_empty(files_.folder() / "not" / "yet"));
}

TEST_F(Flight, EachInputHasTheSimulatedTimeOfItsEra) {
  run(50);
  world().reset();
  run(20);
  world().write_inputs(0, 0, std::vector{0.7, -0.3});
  explode();
  const auto inputs = messages_of(flight_->dump(), kInputTopic);
  ASSERT_EQ(inputs.size(), 3u) << "the reset, the write, the push";
  constexpr std::uint64_t kMs = 1'000'000;
  EXPECT_EQ(inputs[0].times_ns, std::pair(50 * kMs, 50 * kMs));
  EXPECT_EQ(inputs[1].times_ns, std::pair(70 * kMs, 20 * kMs));
}

TEST_F(Flight, MemoryIsBoundedHoweverMuchIsWritten) {
  for (int i = 0; i < 5000; ++i) {
    for (int j = 0; j < 20; ++j) world().write_inputs(0, 0, std::vector{0.01, -0.3});
    run(1);
  }
  explode();
  const auto result = replay(flight_->dump());
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_GT(result.inputs, 10'000u);
  EXPECT_LT(std::filesystem::file_size(flight_->dump()), 2 * FlightRecorder::kInputBytes + (4u << 20));
}

TEST_F(Flight, WhereNoFileCanBeMadeTheWorldFreezesAllTheSame) {
  files_.write("not", "a file where a folder should be");
  run(10);
  explode();
  EXPECT_EQ(flight_->dump(), "");
}

}  // namespace
}  // namespace visum::recording
