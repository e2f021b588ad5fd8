// Scenes that are loaded while a world is recorded: the file holds them, and each reader of the file goes
// through the same bits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/recording/archive.h"
#include "server/recording/flight_recorder.h"
#include "server/recording/player.h"
#include "server/recording/replay.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

const std::filesystem::path kScenes = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes";

std::shared_ptr<const LoadedScene> load(cycle::Simulation& world, const std::filesystem::path& file) {
  auto change = world.begin_load({file, {}, {}, {}});
  EXPECT_EQ(cycle::prepare(change).text(), "");
  EXPECT_EQ(world.load_scene(change).text(), "");
  return change.loaded;
}

// A recorded life of three scenes, of which one is a file that is gone afterwards.
class ALifeOfScenes : public ::testing::Test {
 protected:
  struct Moment {
    std::uint64_t hash, era;
    std::string scene;
  };

  void SetUp() override {
    run(700);
    load(*world, kScenes / "cart.yaml");
    world->write_inputs(0, 0, std::vector{0.1});
    run(1200);
    ASSERT_TRUE(world->add_body(kBall).done());
    run(300);
    {
      const test::TempFiles gone;
      load(*world, gone.write("gone.yaml",
                              "visum: 1\nname: gone\nbodies:\n- {name: ball, mass: 1, pose: {xyz: [0, "
                              "0, 3]}, shapes: [{sphere: 0.1}]}\n"));
    }
    load(*world, kScenes / "cart.yaml");  // and at once again
    load(*world, kScenes / "two_link.yaml");
    world->write_inputs(0, 0, std::vector{0.4});
    run(1500);
    file = world.finish();
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      world->tick();
      moments.push_back({world->state_hash(), world->era(), world->scene().name});
    }
  }

  RecordedWorld world;
  std::vector<Moment> moments;  // after each tick
  std::filesystem::path file;
};

TEST_F(ALifeOfScenes, ReplaysToTheBit) {
  const auto result = replay(file);
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
  EXPECT_EQ(result.damage, "");
  EXPECT_EQ(result.ticks, moments.size());
  EXPECT_EQ(result.last_hash, moments.back().hash);
}

TEST_F(ALifeOfScenes, IsShownAtAnyMoment) {
  Player player(file, {});
  ASSERT_EQ(player.ticks(), moments.size());
  for (const std::uint64_t at : {3700, 1, 700, 701, 2200, 699, 2201, 1900, 3000, 2199, 1701, 702}) {
    SCOPED_TRACE(at);
    player.seek(at);
    EXPECT_EQ(player.world().state_hash(), moments[at - 1].hash);
    EXPECT_EQ(player.world().era(), moments[at - 1].era);
    EXPECT_EQ(player.world().scene().name, moments[at - 1].scene);
  }
  std::vector<std::string> told;
  for (const auto& event : player.events().events()) told.push_back(event.event.text);
  EXPECT_THAT(told, Contains("the scene 'cart' was loaded"));
}

TEST_F(ALifeOfScenes, GoesOnFromAnyMomentWithTheFilesOfItsScene) {
  const auto rewound = rewind(file, 1.5, {}, {});
  EXPECT_EQ(rewound.world->state_hash(), moments[1499].hash);
  EXPECT_EQ(rewound.world->scene().name, "cart");
  EXPECT_TRUE(rewound.origin.files.contains((kScenes / "cart.yaml").lexically_normal().string()));
  const auto with_ode = rewind(file, 1.5, {}, {}, "ode");
  EXPECT_EQ(with_ode.world->scene().name, "cart");
  EXPECT_EQ(with_ode.world->model().engines.front().name, "ode");
}

TEST(LoadingScenes, SnapshotsOnDiskAreOfTheirScene) {
  const test::TempFiles files;
  RecordedWorld world;
  Archive archive(files.folder(), {});
  const auto cart = load(*world, kScenes / "cart.yaml");
  auto origin = origin_of(*cart);
  archive.swap_origin(origin);
  world.run(100);
  State state;
  world->keep(state);
  archive.save(*world, "cart", state);
  const auto hash = world->state_hash();
  const auto robot = load(*world, kScenes / "two_link.yaml");
  origin = origin_of(*robot);
  archive.swap_origin(origin);
  try {
    archive.load(*world, "cart");
    ADD_FAILURE() << "a snapshot of another scene was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("another scene, 'cart'"));
  }
  origin = origin_of(*load(*world, kScenes / "cart.yaml"));
  archive.swap_origin(origin);
  ASSERT_EQ(world->restore_state(archive.load(*world, "cart")).text(), "");
  EXPECT_EQ(world->state_hash(), hash);
}

TEST(LoadingScenes, TheLastTicksBeforeAFreezeAreOfTheSceneThatFroze) {
  const test::TempFiles files;
  config::FilesNoted noted;
  cycle::Simulation world(scene::load_scene(kScenes / "two_link.yaml"));
  FlightRecorder flight(world, {noted.files, {}}, files.folder());
  for (int i = 0; i < 50; ++i) world.tick();
  load(world, kScenes / "cart.yaml");
  for (int i = 0; i < 50; ++i) world.tick();
  ASSERT_TRUE(world.add_body(kBall).done());
  ASSERT_TRUE(world.push({{world.model().find_body("ball"), {1e12, 0, 0}, {0, 0, 0}}, 1000}).done());
  for (int i = 0; i < 100 && !world.frozen(); ++i) world.tick();
  ASSERT_TRUE(world.frozen());
  const auto result = replay(flight.dump());
  EXPECT_EQ(result.header.scene, "cart");
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_GE(result.ticks, 50u);
}

}  // namespace
}  // namespace visum::recording
