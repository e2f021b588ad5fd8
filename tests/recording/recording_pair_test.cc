// Two recordings, compared: where they part.
#include "protocol/recording/recording_pair.h"

#include <gtest/gtest.h>

#include "tests/recording/forge.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

// A world in which a ball is pushed, which no port shows. Its recording moves to `to`.
void record_push(double force_n, int ticks, const std::filesystem::path& to) {
  RecordedWorld world;
  EXPECT_TRUE(world->add_body(kBall).done());
  world.run(10);
  const auto ball = world->model().find_body("ball");
  EXPECT_TRUE(world->push({{ball, {0.0, force_n, 0.0}, {0.0, 0.0, 0.0}}, 15}).done());
  world.run(ticks - 10);
  std::filesystem::copy_file(world.finish(), to);
}

std::optional<RecordingPair::Moment> first_difference(const test::TempFiles& files) {
  RecordingPair pair(files.folder() / "a.mcap", files.folder() / "b.mcap");
  while (pair.next()) {
  }
  return pair.first();
}

TEST(RecordingPair, PartsAtTheNextHashWhereNoPortShowsIt) {
  const test::TempFiles files;
  record_push(0.1, 60, files.folder() / "a.mcap");
  record_push(0.2, 60, files.folder() / "b.mcap");
  const auto first = first_difference(files);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->position, 50u);
  EXPECT_EQ(first->tick, 50);
}

TEST(RecordingPair, PartsAtTheEndWhereOnlyTheStateThereShowsIt) {
  const test::TempFiles files;
  record_push(0.1, 30, files.folder() / "a.mcap");
  record_push(0.2, 30, files.folder() / "b.mcap");
  const auto first = first_difference(files);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->position, 30u);
  EXPECT_EQ(first->tick, 30);
}

TEST(RecordingPair, EqualRunsDoNotPart) {
  const test::TempFiles files;
  record_push(0.1, 30, files.folder() / "a.mcap");
  record_push(0.1, 30, files.folder() / "b.mcap");
  EXPECT_FALSE(first_difference(files));
}

// A scene and a scenario, say, in two folders.
TEST(RecordingPair, TwoFilesWithOneNameAreNotTakenForOneAnother) {
  const test::TempFiles files;
  files.write("world/scene.yaml", "visum: 1\nclock: lockstep\n");
  const auto scene = files.write("scene.yaml", "visum: 1\ninclude: [world/scene.yaml]\n");
  for (const char* name : {"a.mcap", "b.mcap"}) {
    config::FilesNoted noted;
    cycle::Simulation world(scene::load_scene(scene));
    Recorder recorder(world, {noted.files, ""}, files.folder() / name);
    world.tick();
  }
  const RecordingPair pair(files.folder() / "a.mcap", files.folder() / "b.mcap");
  EXPECT_EQ(pair.settings(), std::vector<std::string>{});
}

}  // namespace
}  // namespace visum::recording
