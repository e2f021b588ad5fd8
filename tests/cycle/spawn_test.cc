// Models that come into a world that runs, with their parts and sensors, and go again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "server/cycle/simulation.h"
#include "tests/support/temp_files.h"

namespace visum::cycle {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::filesystem::path kModels = std::filesystem::path(VISUM_SOURCE_DIR) / "models";

class Spawning : public ::testing::Test {
 protected:
  static scene::Scene two_link() { return scene::load_scene(kModels / "scenes/two_link.yaml"); }
  static scene::SpawnOrder cart(const std::string& name, double y = 3.0) {
    return {kModels / "cart/cart.yaml", name, {{0, y, 0}, Eigen::Quaterniond::Identity()}};
  }
  static scene::SpawnOrder robot(const std::string& name, double y = 3.0) {
    return {kModels / "two_link/two_link.urdf", name, {{0, y, 1}, Eigen::Quaterniond::Identity()}};
  }
  std::vector<std::string> parts() const {
    std::vector<std::string> names;
    for (const auto& bound : world.parts()) names.push_back(bound.part->description().name);
    return names;
  }
  std::size_t part(const std::string& name) const {
    const auto names = parts();
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }
  static void run(Simulation& simulation, int ticks) {
    for (int i = 0; i < ticks; ++i) simulation.tick();
    ASSERT_EQ(simulation.fault(), "");
  }
  std::string refusal(const scene::SpawnOrder& order) {
    const auto hash = world.state_hash();
    const auto outcome = world.spawn(order);
    EXPECT_FALSE(outcome.done());
    EXPECT_EQ(world.state_hash(), hash);
    return outcome.text();
  }
  Simulation world{two_link()};
};

TEST_F(Spawning, AModelBringsItsBodiesJointsAndParts) {
  const auto own = parts().size();
  const auto bodies = world.model().bodies.size();
  ASSERT_EQ(world.spawn(cart("second")).text(), "");
  EXPECT_EQ(parts().size(), own + 1);
  EXPECT_EQ(parts().back(), "second");
  EXPECT_GT(world.model().bodies.size(), bodies);
  ASSERT_TRUE(world.model().find_body("second/chassis").valid()) << world.model().bodies.back().name;
  EXPECT_EQ(world.scene().spawned.front().parts, std::vector<std::string>{"second"});
  EXPECT_EQ(world.revision(), 2u);
  run(world, 50);
  const auto at = world.state().bodies[world.model().find_body("second/chassis").index()].p_WC;
  EXPECT_NEAR(at.y(), 3.0, 0.2) << "it stands where it was put";
}

TEST_F(Spawning, IsTheSameMadeReadyOnAnotherThreadWhileTheWorldTicks) {
  Simulation at_once(two_link());
  auto change = world.begin_spawn(cart("second"));
  Outcome ready;
  std::thread worker([&] { ready = prepare(change); });
  run(world, 30);
  worker.join();
  ASSERT_EQ(ready.text(), "");
  ASSERT_EQ(world.change_bodies(change).text(), "");
  run(at_once, 30);
  ASSERT_EQ(at_once.spawn(cart("second")).text(), "");
  run(world, 100);
  run(at_once, 100);
  EXPECT_EQ(world.state_hash(), at_once.state_hash());
}

TEST_F(Spawning, ThePartsOfAModelDriveItsJointsAlsoAfterAnEarlierOneWent) {
  ASSERT_EQ(world.spawn(robot("first", 3.0)).text(), "");
  ASSERT_EQ(world.spawn(robot("second", 6.0)).text(), "");
  ASSERT_EQ(world.remove_model("first").text(), "");
  EXPECT_THAT(parts(), Not(Contains("first")));
  const auto& joints = world.parts()[part("second")].joints;
  ASSERT_FALSE(joints.empty());
  for (const auto joint : joints)
    EXPECT_TRUE(world.model().joints[joint.index()].name.starts_with("second/"));
  const auto& ports = world.parts()[part("second")].part->description().controller_inputs;
  const auto angle = std::ranges::find(ports, "Desired Angle 1", &protocol::Port::name) - ports.begin();
  ASSERT_LT(static_cast<std::size_t>(angle), ports.size());
  world.write_inputs(part("second"), static_cast<std::size_t>(angle), std::vector{0.3});
  run(world, 1000);
  EXPECT_NEAR(world.state().joints[joints.front().index()].position, 0.3, 0.02);
}

TEST_F(Spawning, AModelThatWentLeavesNothingBehind) {
  const auto& before = world.scene();
  const auto bodies = before.world.bodies.size(), shapes = before.world.shapes.size(),
             joints = before.world.joints.size(), pairs = before.world.no_collision.size(),
             meshes = before.world.meshes.size(), models = before.models.size(),
             losses = before.losses.size(), own = parts().size();
  ASSERT_EQ(world.spawn(cart("second")).text(), "");
  run(world, 10);
  ASSERT_EQ(world.remove_model("second").text(), "");
  const auto& after = world.scene();
  EXPECT_EQ(after.world.bodies.size(), bodies);
  EXPECT_EQ(after.world.shapes.size(), shapes);
  EXPECT_EQ(after.world.joints.size(), joints);
  EXPECT_EQ(after.world.no_collision.size(), pairs);
  EXPECT_EQ(after.world.meshes.size(), meshes);
  EXPECT_EQ(after.models.size(), models);
  EXPECT_EQ(after.losses.size(), losses);
  EXPECT_EQ(parts().size(), own);
  recording::State state;
  world.keep(state);
  EXPECT_TRUE(state.edits.empty());
  run(world, 10);
}

TEST_F(Spawning, ATakenNameIsRefusedOrMadeUnique) {
  ASSERT_EQ(world.spawn(cart("cart")).text(), "");
  EXPECT_THAT(refusal(cart("cart")), HasSubstr("the name 'cart' is taken"));
  EXPECT_THAT(refusal(cart("")), HasSubstr("the name 'cart' is taken")) << "the file's own";
  auto order = cart("cart", 6.0);
  order.make_unique = true;
  ASSERT_EQ(world.spawn(order).text(), "");
  order.X_WM.p.y() = 9.0;
  ASSERT_EQ(world.spawn(order).text(), "");
  std::vector<std::string> names;
  for (const auto& model : world.scene().spawned) names.push_back(model.name);
  EXPECT_THAT(names, ElementsAre("cart", "cart_2", "cart_3"));
  EXPECT_THAT(refusal(cart("no/name")), HasSubstr("a model's name"));
}

TEST_F(Spawning, OfAStateIsMadeAgainWithoutADiskToTheBit) {
  ASSERT_EQ(world.spawn(cart("second")).text(), "");
  ASSERT_EQ(world.spawn(robot("third", 6.0)).text(), "");
  run(world, 40);
  recording::State state;
  world.keep(state);
  Simulation other(two_link());
  run(other, 5);
  const config::Files none;
  {
    const config::FilesGiven no_disk(none);
    ASSERT_EQ(other.restore_state(state).text(), "");
  }
  EXPECT_EQ(other.state_hash(), world.state_hash());
  EXPECT_EQ(other.parts().size(), world.parts().size());
  run(world, 100);
  run(other, 100);
  EXPECT_EQ(other.state_hash(), world.state_hash());
}

TEST_F(Spawning, AStateThatDoesNotLoadLeavesModelsAndPartsAsTheyWere) {
  ASSERT_EQ(world.spawn(cart("second")).text(), "");
  recording::State state;
  world.keep(state);
  state.state.resize(state.state.size() / 2);
  Simulation other(two_link());
  ASSERT_EQ(other.spawn(robot("third")).text(), "");
  run(other, 20);
  const auto hash = other.state_hash();
  EXPECT_FALSE(other.restore_state(state).done());
  EXPECT_EQ(other.state_hash(), hash);
  EXPECT_EQ(other.parts().back().part->description().name, "third");
  run(other, 20);
}

TEST_F(Spawning, AResetOfWhatWasSpawnedTakesModelsAway) {
  const auto own = parts();
  ASSERT_EQ(world.spawn(cart("second")).text(), "");
  ASSERT_EQ(world.reset_now(protocol::ResetScope::kSpawned).text(), "");
  EXPECT_EQ(parts(), own);
  ASSERT_EQ(world.spawn(cart("second")).text(), "");
  run(world, 10);
  ASSERT_EQ(world.reset_now(protocol::ResetScope::kAll).text(), "");
  EXPECT_EQ(parts(), own);
  EXPECT_EQ(world.tick_count(), 0);
  Simulation fresh(two_link());
  EXPECT_EQ(world.state_hash(), fresh.state_hash());
}

TEST_F(Spawning, FaultsStayWithTheirParts) {
  ASSERT_EQ(world.spawn(robot("first", 3.0)).text(), "");
  ASSERT_EQ(world.spawn(robot("second", 6.0)).text(), "");
  hwparts::Fault silent;
  silent.kind = hwparts::FaultKind::kPartSilent;
  const auto inject = [&](const std::string& name) {
    return world.inject({static_cast<std::uint32_t>(part(name)), silent, 0});
  };
  ASSERT_TRUE(inject("first").done());
  ASSERT_TRUE(inject("second").done());
  ASSERT_EQ(world.remove_model("first").text(), "");
  ASSERT_EQ(world.faults().size(), 1u);
  EXPECT_EQ(world.faults().front().part, part("second"));
  EXPECT_TRUE(world.parts()[part("second")].silent);
  run(world, 10);
}

TEST_F(Spawning, ThingsThatCannotGoAreRefused) {
  ASSERT_EQ(world.spawn(cart("second")).text(), "");
  EXPECT_THAT(world.remove_model("secnd").text(), HasSubstr("did you mean 'second'"));
  EXPECT_THAT(world.remove_model(world.scene().models.front().name).text(),
              HasSubstr("belongs to the scene"));
  EXPECT_THAT(world.remove_body("second/chassis").text(), HasSubstr("came with the model 'second'"));
  const auto base = world.model().find_body("second/chassis");
  ASSERT_TRUE(world.push({{base, {1, 0, 0}, {0, 0, 0}}, world.tick_count() + 5}).done());
  EXPECT_EQ(world.remove_model("second").text(), "'second/chassis' is being pushed");
}

TEST_F(Spawning, AFileBringsThingsAndNoSettings) {
  const test::TempFiles files;
  const auto yaml = [&](const std::string& text) {
    return scene::SpawnOrder{files.write("thing.yaml", "visum: 1\n" + text), "", {}};
  };
  const std::string body = "bodies: [{name: lamp, mass: 1, shapes: [{sphere: 0.1}]}]\n";
  EXPECT_THAT(refusal(yaml("gravity: [0, 0, 0]\n" + body)), HasSubstr("is for scenes"));
  EXPECT_THAT(refusal(yaml("surfaces: {default: {friction: 0}}\n" + body)), HasSubstr("is the scene's"));
  EXPECT_THAT(refusal(yaml("")), HasSubstr("brings nothing"));
  const auto holds =
      "joints: [{name: j, type: fixed, parent: " + world.model().bodies.back().name + ", child: lamp}]\n";
  EXPECT_THAT(refusal(yaml(body + holds)), HasSubstr("would hold a body that was there before"));
  EXPECT_THAT(refusal(yaml(body + "sensors: [{name: eye, kind: imu, body: " +
                           world.model().bodies.back().name + "}]\n")),
              HasSubstr("was there before"));
  EXPECT_THAT(refusal({files.folder() / "none.urdf", "", {}}), HasSubstr("none.urdf"));
  ASSERT_EQ(world.spawn(yaml(body + "sensors: [{name: eye, kind: imu, body: lamp}]\n")).text(), "");
  EXPECT_THAT(parts(), Contains("eye"));
  EXPECT_THAT(refusal(yaml(body)), HasSubstr("lamp"));
  run(world, 20);
  ASSERT_EQ(world.remove_model("thing").text(), "");
  EXPECT_THAT(parts(), Not(Contains("eye")));
  run(world, 20);
}

}  // namespace
}  // namespace visum::cycle
