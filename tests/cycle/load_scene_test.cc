// Another scene in the place of a world's: it runs as if it had been alone from the beginning, and a load
// that is refused changes nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <thread>

#include "server/cycle/simulation.h"
#include "tests/cycle/text_world.h"
#include "tests/support/temp_files.h"

namespace visum::cycle {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kScenes = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes";

// Commands the first part, if it takes commands, so that the world's hash is about moving drives.
void live(Simulation& world) {
  const auto& inputs = world.parts()[0].part->description().controller_inputs;
  run(world, 20);
  if (!inputs.empty()) world.write_inputs(0, 0, std::vector{std::min(0.2, inputs[0].maximum)});
  run(world, 80);
}

std::uint64_t hash_of_its_own(const std::string& scene, const std::string& engine = {}) {
  Simulation world(scene::load_scene(kScenes / scene, {engine}));
  live(world);
  return world.state_hash();
}

class LoadingScenes : public ::testing::Test {
 protected:
  Outcome load(SceneOrder order) {
    auto change = world.begin_load(std::move(order));
    auto outcome = prepare(change);
    return outcome.done() ? world.load_scene(change) : outcome;
  }
  Outcome load_file(const std::string& scene) { return load({kScenes / scene, {}, {}, {}}); }
  std::string refusal(SceneOrder order) {
    const auto hash = world.state_hash();
    const auto era = world.era();
    const auto outcome = load(std::move(order));
    EXPECT_FALSE(outcome.done());
    EXPECT_EQ(world.state_hash(), hash);
    EXPECT_EQ(world.era(), era);
    EXPECT_EQ(world.scene().name, "two_link");
    return outcome.text();
  }

  const test::TempFiles files;
  Simulation world{scene::load_scene(kScenes / "two_link.yaml")};
};

TEST_F(LoadingScenes, BackAndForthEachRunsAsIfItWereAlone) {
  const auto robot = hash_of_its_own("two_link.yaml");
  const auto cart = hash_of_its_own("cart.yaml");
  const auto sensors = hash_of_its_own("sensors.yaml");
  ASSERT_NE(robot, cart);
  for (int round = 0; round < 3; ++round) {
    SCOPED_TRACE(round);
    ASSERT_EQ(load_file("cart.yaml").text(), "");
    EXPECT_EQ(world.tick_count(), 0);
    live(world);
    EXPECT_EQ(world.state_hash(), cart);
    ASSERT_EQ(load_file("sensors.yaml").text(), "");
    live(world);
    EXPECT_EQ(world.state_hash(), sensors);
    ASSERT_EQ(load_file("two_link.yaml").text(), "");
    live(world);
    EXPECT_EQ(world.state_hash(), robot);
  }
  EXPECT_EQ(world.era(), 10u);
  EXPECT_EQ(world.scene_number(), 10u);
}

// Engines like ODE are made on the thread of the tick.
TEST_F(LoadingScenes, TakesAnotherEngineAndSeedWhereTheyAreAsked) {
  ASSERT_EQ(load({kScenes / "cart.yaml", "ode", {}, {}}).text(), "");
  live(world);
  EXPECT_EQ(world.state_hash(), hash_of_its_own("cart.yaml", "ode"));
  ASSERT_EQ(load({kScenes / "cart.yaml", {}, 77, {}}).text(), "");
  EXPECT_EQ(world.scene().seed, 77u);
}

TEST_F(LoadingScenes, IsTheSameMadeReadyOnAnotherThreadWhileTheWorldTicks) {
  auto change = world.begin_load({kScenes / "cart.yaml", {}, {}, {}});
  Outcome ready;
  std::thread worker([&] { ready = prepare(change); });
  run(world, 30);
  worker.join();
  ASSERT_EQ(ready.text(), "");
  EXPECT_EQ(world.tick_count(), 30);
  ASSERT_EQ(world.load_scene(change).text(), "");
  live(world);
  EXPECT_EQ(world.state_hash(), hash_of_its_own("cart.yaml"));
}

TEST_F(LoadingScenes, NothingOfTheSceneBeforeIsLeft) {
  const auto snapshot = world.take_snapshot();
  ASSERT_EQ(
      world.add_body("{name: ball, mass: 0.5, pose: {xyz: [1, 1, 2]}, shapes: [{sphere: 0.05}]}").text(), "");
  const auto ball = world.model().find_body("ball");
  ASSERT_TRUE(world.push({{ball, {1, 0, 0}, {0, 0, 0}}, 1000}).done());
  ASSERT_TRUE(world.pull({ball, {0, 0, 0}, {1, 1, 3}, 5.0, 0}).done());
  const auto later = world.take_snapshot();
  ASSERT_EQ(load_file("cart.yaml").text(), "");
  EXPECT_TRUE(world.pulls().empty());
  EXPECT_THAT(world.restore_snapshot(snapshot).text(), HasSubstr("of the scene before"));
  EXPECT_THAT(world.restore_snapshot(later).text(), HasSubstr("of the scene before"));
  EXPECT_EQ(world.restore_snapshot(99).text(), "there is no snapshot 99");
  EXPECT_EQ(world.take_snapshot(), later + 1) << "numbers are given once";
  world.reset();
  live(world);
  EXPECT_EQ(world.state_hash(), hash_of_its_own("cart.yaml"));
  ASSERT_EQ(world.reset_now(protocol::ResetScope::kAll).text(), "");
  EXPECT_EQ(world.scene().name, "cart") << "the scene as it was loaded last";
}

TEST_F(LoadingScenes, RevivesAFrozenWorld) {
  ASSERT_EQ(
      world.add_body("{name: ball, mass: 0.5, pose: {xyz: [1, 1, 2]}, shapes: [{sphere: 0.05}]}").text(), "");
  ASSERT_TRUE(world.push({{world.model().find_body("ball"), {1e12, 0, 0}, {0, 0, 0}}, 1000}).done());
  for (int i = 0; i < 100 && !world.frozen(); ++i) world.tick();
  ASSERT_TRUE(world.frozen());
  ASSERT_EQ(load_file("cart.yaml").text(), "");
  EXPECT_FALSE(world.frozen());
  live(world);
  EXPECT_EQ(world.state_hash(), hash_of_its_own("cart.yaml"));
}

TEST_F(LoadingScenes, ClockPaceAndThreadsStay) {
  auto scene = scene::load_scene(kScenes / "two_link.yaml");
  scene.clock = scene::ClockKind::kFree;
  scene.speed = 3.0;
  scene.world.engines.front().threads = 2;
  Simulation other(std::move(scene));
  auto change = other.begin_load({kScenes / "cart.yaml", {}, {}, {}});
  ASSERT_EQ(prepare(change).text(), "");
  ASSERT_EQ(other.load_scene(change).text(), "");
  EXPECT_EQ(other.scene().clock, scene::ClockKind::kFree);
  EXPECT_EQ(other.scene().speed, 3.0);
  EXPECT_EQ(other.model().engines.front().threads, 2);
}

TEST_F(LoadingScenes, RefusesASceneThatIsWrongWithFileAndLine) {
  run(world, 10);
  const auto broken = files.write("broken.yaml", "visum: 1\nbodies:\n- {name: ball, mas: 1}\n");
  EXPECT_THAT(refusal({broken, {}, {}, {}}), HasSubstr("broken.yaml:3"));
  EXPECT_THAT(refusal({files.folder() / "none.yaml", {}, {}, {}}), HasSubstr("none.yaml"));
  const auto half = files.write(
      "half.yaml", "visum: 1\nbodies:\n- {name: wedge, fixed: true, shapes: [{mesh: gone.stl}]}\n");
  EXPECT_THAT(refusal({half, {}, {}, {}}), AllOf(HasSubstr("half.yaml:3"), HasSubstr("gone.stl")));
  EXPECT_THAT(refusal({kScenes / "cart.yaml", "warp", {}, {}}), HasSubstr("warp"));
  run(world, 10);
}

TEST_F(LoadingScenes, RefusesAnotherTick) {
  const auto slow = files.write(
      "slow.yaml", "visum: 1\ntick_ms: 2\nbodies:\n- {name: ball, mass: 1, shapes: [{sphere: 0.1}]}\n");
  EXPECT_THAT(refusal({slow, {}, {}, {}}),
              HasSubstr("ticks of 2000000 ns, this server runs with 1000000 ns"));
}

TEST_F(LoadingScenes, RefusesPlugInsWithoutOpeningThem) {
  EXPECT_THAT(refusal({kScenes / "explorer_agent.yaml", {}, {}, {}}),
              AllOf(HasSubstr("explorer_agent.yaml:6"), HasSubstr("plug-ins come only with the scene")));
}

// A file of 16 MiB and more that the scene names: a recording could not hold it.
TEST_F(LoadingScenes, RefusesFilesThatARecordingCannotHold) {
  std::string mesh = "# a wedge\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  mesh.resize(SceneChange::kMostFileBytes, '\n');
  files.write("large.obj", mesh);
  const auto large = files.write(
      "large.yaml",
      "visum: 1\nbodies:\n- {name: wedge, fixed: true, shapes: [{mesh: large.obj, collides: false}]}\n");
  EXPECT_THAT(refusal({large, {}, {}, {}}), HasSubstr("the files of the scene have"));
}

}  // namespace
}  // namespace visum::cycle
