// The player shows any tick of a recording with the bits that it had, with and without states in the file.
#include "server/recording/player.h"

#include <gtest/gtest.h>

#include <utility>

#include "server/recording/port_reader.h"
#include "server/recording/replay.h"
#include "tests/recording/forge.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

// A world's hash and ports after each of its ticks.
struct Moment {
  std::int64_t tick;
  std::uint64_t era, hash;
  std::vector<double> outputs;
};

class Life {
 public:
  explicit Life(const std::string& scene = "two_link.yaml", const std::string& engine = {})
      : world_(scene, engine) {
    note();
  }
  RecordedWorld& world() { return world_; }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      world_.run(1);
      note();
    }
  }
  std::filesystem::path finish() { return world_.finish(); }
  std::vector<Moment> moments;  // by position

 private:
  void note() {
    moments.push_back({world_->tick_count(), world_->era(), world_->state_hash(),
                       std::as_const(*world_).parts()[0].sensor_outputs});
  }
  RecordedWorld world_;
};

// Lasts over two seconds and has everything that makes going back hard: bodies that come and go, a snapshot
// that is restored in another second than it was taken, and a reset.
void live(Life& life) {
  auto& world = life.world();
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  life.run(700);
  EXPECT_TRUE(world->add_body(kBall).done());
  life.run(200);
  const auto snapshot = world->take_snapshot();
  EXPECT_TRUE(world
                  ->push({{world->model().find_body("ball"), {1.0, 0.5, 0.0}, {0.0, 0.0, 0.1}},
                          world->tick_count() + 150})
                  .done());
  life.run(400);
  ASSERT_TRUE(world->restore_snapshot(snapshot).done());
  world->write_inputs(0, 1, std::vector{0.9});
  life.run(800);
  ASSERT_EQ(world->remove_body("ball").text(), "");
  life.run(100);
  world->reset();
  life.run(300);
}

constexpr std::uint64_t kSomewhere[] = {2500, 0,   1300, 1000, 999,  1001, 2000,
                                        699,  701, 1301, 2499, 2201, 1,    2100};

void expect_moment(const Player& player, const Moment& moment) {
  EXPECT_EQ(player.world().tick_count(), moment.tick);
  EXPECT_EQ(player.world().era(), moment.era);
  EXPECT_EQ(player.world().state_hash(), moment.hash);
}

class PlayerOf : public testing::TestWithParam<const char*> {};

TEST_P(PlayerOf, GoesToAnyTickWithTheBitsThatItHad) {
  Life life("two_link.yaml", GetParam());
  live(life);
  Player player(life.finish(), {});
  ASSERT_EQ(player.ticks(), 2500u);
  EXPECT_EQ(player.damage(), "");
  for (const auto position : kSomewhere) {
    SCOPED_TRACE(position);
    player.seek(position);
    EXPECT_EQ(player.position(), position);
    expect_moment(player, life.moments[position]);
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, PlayerOf, testing::Values("impulse", "ode"),
                         [](const auto& info) { return std::string(info.param); });

class PlayerOfScene : public testing::TestWithParam<const char*> {};

// Everything that a world remembers is in its state: a fresh one goes on from there as the recorded one did.
TEST_P(PlayerOfScene, GoesOnFromAStateWithTheSameBits) {
  Life life(GetParam());
  life.run(1050);
  Player player(life.finish(), {});
  player.seek(1000);
  expect_moment(player, life.moments[1000]);
  player.seek(1050);
  expect_moment(player, life.moments[1050]);
}

INSTANTIATE_TEST_SUITE_P(
    All, PlayerOfScene,
    testing::Values("amtec_arm.yaml", "cart.yaml", "crawler.yaml", "explorer.yaml", "explorer_ray.yaml",
                    "sensors.yaml", "two_link.yaml"),
    [](const auto& info) {
      return std::string(std::string_view(info.param).substr(0, std::string_view(info.param).find('.')));
    });

// Faults, and messages that are under way on a late network, also go on from a state.
TEST(Player, GoesOnWithFaultsAndMessagesUnderWay) {
  Life life("amtec_arm.yaml");
  const auto inject = [&](const char* kind, const hwparts::NamedNumbers& numbers) {
    std::string why;
    const auto fault = hwparts::make_fault(kind, numbers, why);
    ASSERT_TRUE(fault) << why;
    ASSERT_TRUE(life.world()->inject({0, *fault, 0}).done());
  };
  inject("encoder_noise", {{"joint", 2}, {"deviation", 1e-3}});
  inject("network_delay", {{"ms", 7}, {"jitter_ms", 9}});
  for (int i = 0; i < 525; ++i) {
    life.world()->write_inputs(0, 0, std::vector{0.001 * i});
    life.run(2);
  }
  Player player(life.finish(), {});
  player.seek(1000);
  player.seek(1050);
  expect_moment(player, life.moments[1050]);
}

TEST(Player, GoesOnToTheEndAndNoFurther) {
  Life life;
  life.run(1100);
  Player player(life.finish(), {});
  player.seek(1090);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(player.advance());
  EXPECT_FALSE(player.advance());
  EXPECT_EQ(player.position(), 1100u);
  expect_moment(player, life.moments[1100]);
  player.seek(99'999);
  EXPECT_EQ(player.position(), 1100u);
}

// The states that stand there, that of a simulated second and that of the end, hold no contacts, and an input
// that came after the last tick is in the other one.
TEST(Player, TheEndIsThatOfTheLastTickWithItsContacts) {
  Life life;
  for (const char* body :
       {"{name: slab, pose: {xyz: [3, 0, 0]}, fixed: true, shapes: [{box: [1, 1, 1]}]}",
        "{name: box, pose: {xyz: [3, 0, 0.6]}, mass: 1, shapes: [{box: [0.2, 0.2, 0.2]}]}"})
    ASSERT_EQ(life.world()->add_body(body).text(), "");
  life.run(1000);
  const auto contacts = life.world()->contacts().size();
  ASSERT_GT(contacts, 0u);
  life.world()->lose_controller(0);
  Player player(life.finish(), {});
  player.seek(1000);
  expect_moment(player, life.moments[1000]);
  EXPECT_EQ(player.world().contacts().size(), contacts);
}

TEST(Player, GoesThroughAFileWithoutStatesFromItsBeginning) {
  Life life;
  live(life);
  const auto file = life.world().files().folder() / "old.mcap";
  forge(
      life.finish(), file, "", 0, [](auto&) {}, [](std::string_view topic) { return topic != kStateTopic; });
  Player player(file, {});
  for (const std::uint64_t position : {1300u, 701u, 2500u, 0u}) {
    player.seek(position);
    expect_moment(player, life.moments[position]);
  }
}

TEST(Player, ShowsPortsAsTheyWereRecordedWhereTheWorldGoesAnotherWay) {
  Life life;
  life.world()->write_inputs(0, 0, std::vector{0.7, -0.3});
  life.run(1200);
  const auto forged = life.world().files().folder() / "forged.mcap";
  InputMessage message;  // the forged file asks for another value than its later ticks show
  const auto other = [&](std::vector<std::byte>& bytes) {
    message.decode(bytes);
    bytes.clear();
    encode(TimedInput{0, 1, WriteInputs{"robot", 0, std::vector{0.1, 0.1}}}, bytes);
  };
  forge(life.finish(), forged, kInputTopic, 0, other);
  Player player(forged, {});
  player.seek(500);
  EXPECT_NE(player.world().state_hash(), life.moments[500].hash);
  ASSERT_NE(player.sample("robot"), nullptr);
  EXPECT_EQ(player.sample("robot")->sensor_outputs, life.moments[500].outputs);
  player.seek(1100);
  EXPECT_EQ(player.world().state_hash(), life.moments[1100].hash) << "the state in the file has put it right";
  EXPECT_FALSE(replay(forged).equal);
}

// No tick happened after the world was rewound, so the player shows the state that the recording begins with.
TEST(Player, ShowsTheStateThatIsAllThatThereIs) {
  Life life;
  life.world()->write_inputs(0, 0, std::vector{0.7, -0.3});
  life.run(300);
  const auto first = life.finish();
  const auto second = first.parent_path() / "second.mcap";
  {
    auto [again, origin] = rewind(first, 0.2, {});
    const Recorder recorder(*again, origin, second);
  }
  Player player(second, {});
  EXPECT_EQ(player.ticks(), 0u);
  EXPECT_EQ(player.position(), 0u);
  expect_moment(player, life.moments[200]);
  EXPECT_FALSE(player.advance());
}

// A state is checked as an input is: it is restored as a whole, or not at all.
TEST(Player, AStateThatIsNoneIsPassedOver) {
  Life life;
  life.run(1200);
  const auto recorded = life.finish();
  State state;
  const auto spoilt = [&](const std::function<void(State&)>& spoil) {
    return [&, spoil](std::vector<std::byte>& bytes) {
      ASSERT_TRUE(decode(bytes, state));
      spoil(state);
      bytes.clear();
      encode(state, bytes);
    };
  };
  const std::vector<std::function<void(State&)>> ways{
      [](State& s) { s.state.resize(s.state.size() / 2); },
      [](State& s) { s.state.clear(); },
      [](State& s) { std::fill_n(s.state.begin() + 8, 8, std::byte{0xff}); },    // the number of bodies
      [](State& s) { std::fill_n(s.state.begin() + 16, 64, std::byte{0xff}); },  // where they are
      [](State& s) {
        s.snapshots.push_back({1, {std::byte{1}}});
      },
      [](State& s) {
        s.edits.push_back({State::Edit::Kind::kBodyWent, "nobody", nullptr});
      },
      [](State& s) {
        s.edits.push_back({State::Edit::Kind::kBodyCame, "{name: [", nullptr});
      },
  };
  for (std::size_t i = 0; i < ways.size(); ++i) {
    SCOPED_TRACE(i);
    const auto file = life.world().files().folder() / "spoilt.mcap";
    forge(recorded, file, kStateTopic, 0, spoilt(ways[i]));
    Player player(file, {});
    player.seek(1150);
    EXPECT_EQ(player.position(), 1150u);
    EXPECT_FALSE(player.world().frozen());
    player.seek(10);
    expect_moment(player, life.moments[10]);
  }
}

// A state lies between the file's beginning, where its channels are described, and the first ticks that are
// asked for.
TEST(PortReader, ReadsTicksThatLieBehindAStateFirst) {
  Life life;
  life.run(1500);
  const auto file = life.finish();
  const Player player(file, {});
  ASSERT_FALSE(player.points().empty());
  ASSERT_LT(player.points().front().position, 1200u);
  PortReader ports(file, player.points());
  const auto rows = ports.read("robot", 1500, 300);
  const auto& part = player.world().parts()[0];
  const auto width = 1 + part.controller_inputs.size() + part.sensor_outputs.size();
  ASSERT_EQ(rows.values.size(), 300 * width);
  EXPECT_EQ(rows.positions.front(), 1201u);
  EXPECT_EQ(rows.positions.back(), 1500u);
  const auto& last = life.moments[1500].outputs;
  EXPECT_TRUE(
      std::equal(last.begin(), last.end(), rows.values.end() - static_cast<std::ptrdiff_t>(last.size())));
}

}  // namespace
}  // namespace visum::recording
