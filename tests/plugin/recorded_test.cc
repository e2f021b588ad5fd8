// Agents in recordings: a replay shows them the same pictures, so they do the same.
#include <gtest/gtest.h>

#include "server/recording/player.h"
#include "server/recording/recorder.h"
#include "server/recording/replay.h"
#include "tests/plugin/plugged_scene.h"

namespace visum {
namespace {

constexpr const char* kFallingBallIsSeen = R"(visum: 1
clock: realtime
plugins: [kinds]
bodies: [{name: ball, mass: 1, shapes: [{sphere: 0.2}], pose: {xyz: [2, 0, 0.5]}}]
sensors: [{name: eye, kind: camera, size: [64, 48], fov_deg: 60, rate_hz: 500, latency_ms: 4}]
agents: [{name: judge, kind: onlooker, period_ms: 5, parts: {eye: eye}}]
)";
constexpr int kTicks = 300;

class AgentThatLooks : public testing::Test {
 protected:
  // Returns the hash after all ticks.
  std::uint64_t record(scene::ClockKind clock) {
    config::FilesNoted noted;
    auto scene = scene::load_scene(files_.write("s.yaml", kFallingBallIsSeen), test::plugin_options());
    scene.clock = clock;
    cycle::Simulation simulation(std::move(scene));
    const recording::Recorder recorder(simulation, {noted.files, ""}, file());
    test::run(simulation, kTicks);
    EXPECT_GT(test::output_of(simulation, "judge", "Sum"), 0.0);
    return simulation.state_hash();
  }
  std::filesystem::path file() const { return files_.folder() / "run.mcap"; }
  const recording::PluginFolders folders_ = test::plugin_options().plugin_folders;

 private:
  test::TempFiles files_;
};

TEST_F(AgentThatLooks, SeesTheSameUnderEveryClock) {
  EXPECT_EQ(record(scene::ClockKind::kRealtime), record(scene::ClockKind::kLockstep));
}

TEST_F(AgentThatLooks, SeesTheSameInAReplay) {
  const auto hash = record(scene::ClockKind::kLockstep);
  const auto result = recording::replay(file(), folders_);
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
  EXPECT_EQ(result.last_hash, hash);
}

TEST_F(AgentThatLooks, SeesTheSameWhereItIsShownOrGoneOnWith) {
  const auto hash = record(scene::ClockKind::kFree);
  const auto in_real_time = [](scene::Scene& scene) { scene.clock = scene::ClockKind::kRealtime; };
  recording::Player player(file(), folders_, in_real_time);
  player.seek(kTicks);
  EXPECT_EQ(player.world().state_hash(), hash);
  const auto again = recording::rewind(file(), 0.2, in_real_time, folders_).world;
  test::run(*again, kTicks - 200);
  EXPECT_EQ(again->state_hash(), hash);
}

}  // namespace
}  // namespace visum
