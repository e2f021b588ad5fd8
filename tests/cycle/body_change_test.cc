// Changes of the bodies that are made ready beside the world, and what may happen to it meanwhile.
#include "server/cycle/body_change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <thread>

#include "server/cycle/attempt.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {
namespace {

using ::testing::HasSubstr;

constexpr const char* kBall = "{name: ball, mass: 0.5, pose: {xyz: [1, 0, 2]}, shapes: [{sphere: 0.1}]}";

recording::State::Edit came(const char* yaml) {
  return {recording::State::Edit::Kind::kBodyCame, yaml, nullptr};
}
recording::State::Edit went(const char* name) {
  return {recording::State::Edit::Kind::kBodyWent, name, nullptr};
}

class BodyChanging : public ::testing::Test {
 protected:
  static scene::Scene two_link() {
    return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
  }
  static void run(Simulation& simulation, int ticks) {
    for (int i = 0; i < ticks; ++i) simulation.tick();
  }
  Simulation world{two_link()};
};

TEST_F(BodyChanging, MayBeMadeReadyOnAnotherThreadWhileTheWorldTicks) {
  Simulation at_once(two_link());
  run(world, 10);
  run(at_once, 30);
  auto change = world.begin_change(came(kBall));
  Outcome ready;
  std::thread worker([&] { ready = prepare(change); });
  run(world, 20);
  worker.join();
  ASSERT_EQ(ready.text(), "");
  ASSERT_EQ(world.change_bodies(change).text(), "");
  ASSERT_EQ(at_once.add_body(kBall).text(), "");
  run(world, 100);
  run(at_once, 100);
  EXPECT_EQ(world.state_hash(), at_once.state_hash()) << "it acts as of the tick at which it was taken";
}

TEST_F(BodyChanging, OfAWorldWhoseBodiesChangedMeanwhileIsRefused) {
  auto change = world.begin_change(came(kBall));
  ASSERT_EQ(prepare(change).text(), "");
  ASSERT_EQ(world.add_body(kBall).text(), "");
  const auto before = world.state_hash();
  const auto outcome = world.change_bodies(change);
  EXPECT_EQ(outcome.refusal(), Refusal::kWrongState);
  EXPECT_EQ(outcome.text(), "the bodies have changed meanwhile");
  EXPECT_EQ(world.state_hash(), before);
  EXPECT_EQ(world.revision(), 2u);
}

TEST_F(BodyChanging, ABodyThatIsPushedWhenItsTurnComesStays) {
  ASSERT_EQ(world.add_body(kBall).text(), "");
  auto change = world.begin_change(went("ball"));
  ASSERT_EQ(prepare(change).text(), "");
  const auto ball = world.model().find_body("ball");
  ASSERT_TRUE(world.push({{ball, {1, 0, 0}, {0, 0, 0}}, world.tick_count() + 1}).done());
  EXPECT_EQ(world.change_bodies(change).text(), "'ball' is being pushed");
  run(world, 1);
  EXPECT_EQ(world.change_bodies(change).text(), "") << "the same change, once the push is over";
  EXPECT_FALSE(world.model().find_body("ball").valid());
}

TEST_F(BodyChanging, TheOldSceneStaysUntilTheChangeIsFreed) {
  std::weak_ptr<const scene::Scene> old;
  {
    auto first = world.begin_change(came(kBall));
    ASSERT_EQ(prepare(first).text(), "");
    ASSERT_EQ(world.change_bodies(first).text(), "");
    auto change = world.begin_change(went("ball"));
    old = change.scene;
    ASSERT_EQ(prepare(change).text(), "");
    ASSERT_EQ(world.change_bodies(change).text(), "");
    EXPECT_FALSE(old.expired());
    EXPECT_NE(change.machinery.collision, nullptr) << "the old machinery is the caller's to free";
  }
  EXPECT_TRUE(old.expired());
  run(world, 10);
}

TEST_F(BodyChanging, TheTextsOfAllBodiesAreBounded) {
  const std::string comment = "# " + std::string(900'000, 'x') + "\n";
  const auto before = world.model().bodies.size();
  Outcome outcome;
  for (int i = 0; i < 30 && outcome.done(); ++i)
    outcome =
        world.add_body(comment + "{name: b" + std::to_string(i) + ", mass: 1, shapes: [{sphere: 0.1}]}");
  EXPECT_EQ(outcome.refusal(), Refusal::kFull);
  EXPECT_THAT(outcome.text(), HasSubstr("16777216 bytes of text together"));
  EXPECT_EQ(world.model().bodies.size(), before + 18);
  ASSERT_EQ(world.remove_body("b0").text(), "");
  EXPECT_EQ(world.add_body(comment + "{name: b0, mass: 1, shapes: [{sphere: 0.1}]}").text(), "");
}

TEST(Attempt, MemoryThatRunsOutIsARefusal) {
  const auto outcome = attempt(Refusal::kBadValue, [] { throw std::bad_alloc(); });
  EXPECT_EQ(outcome.refusal(), Refusal::kNoMemory);
  EXPECT_THAT(outcome.text(), HasSubstr("not enough memory"));
}

}  // namespace
}  // namespace visum::cycle
