// Two recordings, compared: where they part.
#include "protocol/recording/recording_pair.h"

#include <gtest/gtest.h>

#include "server/recording/replay.h"
#include "tests/recording/messages.h"
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

std::optional<RecordingPair::Moment> where_pushes_part(double force_a_n, double force_b_n, int ticks) {
  const test::TempFiles files;
  record_push(force_a_n, ticks, files.folder() / "a.mcap");
  record_push(force_b_n, ticks, files.folder() / "b.mcap");
  return first_difference(files);
}

TEST(RecordingPair, PartsAtTheNextHashWhereNoPortShowsIt) {
  const auto first = where_pushes_part(0.1, 0.2, 60);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->position, 51u) << "the first tick has a hash, and every 50th after it";
  EXPECT_EQ(first->tick, 51);
}

TEST(RecordingPair, PartsAtTheEndWhereOnlyTheStateThereShowsIt) {
  const auto first = where_pushes_part(0.1, 0.2, 30);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->position, 30u);
  EXPECT_EQ(first->tick, 30);
}

TEST(RecordingPair, EqualRunsDoNotPart) {
  EXPECT_FALSE(where_pushes_part(0.1, 0.1, 30));
}

TEST(RecordingPair, OneThatBeginsWithAStateIsEqualToOneThatDoesNot) {
  const test::TempFiles files;
  record_push(0.1, 60, files.folder() / "a.mcap");
  {
    auto [world, origin] = rewind(files.folder() / "a.mcap", 0.0, {});
    Recorder recorder(*world, origin, files.folder() / "b.mcap");
    EXPECT_TRUE(world->add_body(kBall).done());
    for (int i = 0; i < 60; ++i) {
      if (i == 10) {
        const dynamics::Wrench push{world->model().find_body("ball"), {0.0, 0.1, 0.0}, {0.0, 0.0, 0.0}};
        EXPECT_TRUE(world->push({push, 15}).done());
      }
      world->tick();
    }
    recorder.end();
  }
  EXPECT_EQ(messages_of(files.folder() / "b.mcap", "/states").size(), 2u);
  EXPECT_FALSE(first_difference(files));
}

// When a controller leaves after the last tick is a question of the wall clock.
TEST(RecordingPair, InputsThatOnlyOneHasBehindItsLastTickAreNoDifference) {
  const test::TempFiles files;
  for (const char* name : {"a.mcap", "b.mcap"}) {
    RecordedWorld world;
    world.run(30);
    if (*name == 'a') world->write_inputs(0, 0, std::vector{0.7, -0.3});
    std::filesystem::copy_file(world.finish(), files.folder() / name);
  }
  EXPECT_FALSE(first_difference(files));
}

// A scene and a scenario, say, in two folders.
TEST(RecordingPair, TwoFilesWithOneNameAreNotTakenForOneAnother) {
  const test::TempFiles files;
  const std::string slow = "visum: 1\nclock: lockstep\n", fast = "visum: 1\nclock: free\n";
  const auto scene = files.write("scene.yaml", "visum: 1\ninclude: [a/scene.yaml, b/scene.yaml]\n");
  const auto record = [&](const std::string& a, const std::string& b, const char* name) {
    files.write("a/scene.yaml", a);
    files.write("b/scene.yaml", b);
    config::FilesNoted noted;
    cycle::Simulation world(scene::load_scene(scene));
    const Recorder recorder(world, {noted.files, ""}, files.folder() / name);
  };
  const auto settings = [&] {
    return RecordingPair(files.folder() / "a.mcap", files.folder() / "b.mcap").settings();
  };
  record(slow, fast, "a.mcap");
  record(slow, fast, "b.mcap");
  EXPECT_EQ(settings(), std::vector<std::string>{});
  record(fast, slow, "b.mcap");
  EXPECT_EQ(settings(), std::vector<std::string>(2, "file scene.yaml: not the same content"));
}

TEST(RecordingPair, AFileThatOnlyOneHasIsNamed) {
  const test::TempFiles files;
  const auto record = [&](const std::string& included, const char* name) {
    const auto scene = files.write("scene.yaml", "visum: 1\ninclude: [" + included + "]\n");
    files.write(included, "visum: 1\nclock: free\n");
    config::FilesNoted noted;
    cycle::Simulation world(scene::load_scene(scene));
    const Recorder recorder(world, {noted.files, ""}, files.folder() / name);
  };
  record("one.yaml", "a.mcap");
  record("other.yaml", "b.mcap");
  const RecordingPair pair(files.folder() / "a.mcap", files.folder() / "b.mcap");
  EXPECT_FALSE(pair.same_files());
  const std::vector<std::string> told{"file one.yaml: in A only", "file other.yaml: in B only",
                                      "file scene.yaml: not the same content"};
  EXPECT_EQ(pair.settings(), told);
}

}  // namespace
}  // namespace visum::recording
