// Worlds that go on from a moment of a recording.
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <cstring>
#include <limits>
#include <sstream>

#include "server/recording/replay.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

TEST(Rewind, GoesOnFromAMomentWithTheSameBitsOrWithOtherInputs) {
  RecordedWorld world;
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(30);
  const auto at_30 = world->state_hash();
  world.run(20);
  world->write_inputs(0, 0, std::vector{0.2});
  world.run(10);
  const auto at_60 = world->state_hash();
  const auto file = world.finish();
  const auto again =
      rewind(file, 0.030, [](scene::Scene& scene) { scene.clock = scene::ClockKind::kFree; }).world;
  EXPECT_EQ(again->tick_count(), 30);
  EXPECT_EQ(again->scene().clock, scene::ClockKind::kFree);
  EXPECT_EQ(again->state_hash(), at_30);
  for (int i = 0; i < 20; ++i) again->tick();
  again->write_inputs(0, 0, std::vector{0.2});
  for (int i = 0; i < 10; ++i) again->tick();
  EXPECT_EQ(again->state_hash(), at_60) << "the same input";

  const auto other = rewind(file, 0.030, {}).world;
  other->write_inputs(0, 0, std::vector{0.9});
  for (int i = 0; i < 30; ++i) other->tick();
  EXPECT_NE(other->state_hash(), at_60) << "another input";
  EXPECT_EQ(rewind(file, std::numeric_limits<double>::infinity(), {}).world->tick_count(), 60) << "the end";
}

// A recording of a world with a past begins with its state, so that a replay does not need the past.
TEST(Rewind, WhatComesAfterwardsCanBeRecordedAndGoneThroughAgain) {
  RecordedWorld world;
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(30);
  EXPECT_TRUE(
      world->add_body("{name: ball, mass: 0.5, pose: {xyz: [0.6, 0.5, 1.0]}, shapes: [{sphere: 0.05}]}")
          .done());
  world->reset();
  const auto first = world.finish();
  const auto second = first.parent_path() / "second.mcap";
  auto [again, origin] = rewind(first, std::numeric_limits<double>::infinity(), {});
  {
    Recorder recorder(*again, origin, second);
    again->write_inputs(0, 0, std::vector{0.2});
    for (int i = 0; i < 20; ++i) again->tick();
  }
  const auto result = replay(second);
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_EQ(result.ticks, 20u);
  EXPECT_EQ(result.last_hash, again->state_hash());
}

TEST(Rewind, TheBeginningIsTheStateThatARecordingBeginsWith) {
  RecordedWorld world;
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(30);
  const auto hash = world->state_hash();
  const auto first = world.finish();
  const auto second = first.parent_path() / "second.mcap";
  {
    auto [again, origin] = rewind(first, 0.030, {});
    Recorder recorder(*again, origin, second);
    for (int i = 0; i < 20; ++i) again->tick();
  }
  const auto again = rewind(second, 0.0, {}).world;
  EXPECT_EQ(again->tick_count(), 30);
  EXPECT_EQ(again->state_hash(), hash);
  EXPECT_EQ(replay(second).ticks, 20u);
}

TEST(Rewind, AnotherEngineGoesOnFromTheSameBodies) {
  RecordedWorld world("two_link.yaml", "ode");
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(30);
  EXPECT_TRUE(world->add_body(kBall).done());
  world.run(30);
  const world::WorldState before = world->state();
  world.run(20);
  const auto first = world.finish();
  const auto second = first.parent_path() / "second.mcap";
  auto [other, origin] = rewind(first, 0.060, {}, {}, "impulse");
  EXPECT_EQ(other->model().engines.at(0).name, "impulse");
  EXPECT_EQ(other->tick_count(), 60);
  EXPECT_TRUE(other->state().engines.at(0).empty()) << "ODE's is nothing to go on from";
  ASSERT_EQ(other->state().bodies.size(), before.bodies.size());
  for (std::size_t i = 0; i < before.bodies.size(); ++i) {
    EXPECT_EQ(other->state().bodies[i].p_WC, before.bodies[i].p_WC) << i;
    EXPECT_EQ(other->state().bodies[i].w_WB, before.bodies[i].w_WB) << i;
  }
  {
    Recorder recorder(*other, origin, second);
    for (int i = 0; i < 20; ++i) other->tick();
  }
  EXPECT_EQ(other->fault(), "");
  for (std::size_t i = 0; i < before.joints.size(); ++i)
    EXPECT_NEAR(other->state().joints[i].position, world->state().joints[i].position, 1e-3) << i;
  const auto result = replay(second);
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_EQ(result.last_hash, other->state_hash());
  EXPECT_THROW(rewind(first, 0.060, {}, {}, "clockwork"), std::runtime_error);
}

// Where the last chunk of a recording begins.
std::size_t last_chunk_of(const std::string& bytes) {
  std::size_t last = 0;
  for (std::size_t at = 8; at + 9 < bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 1], 8);
    if (bytes[at] == 0x06) last = at;
    at += 9 + length;
  }
  return last;
}

TEST(Rewind, WhatCannotBeReadIsNotPassedOverInSilence) {
  RecordedWorld world;
  world.run(500);
  const std::string long_line = "\n# " + std::string(1'000'000, 'x');
  EXPECT_TRUE(world->add_body(kBall + long_line).done());  // ends a chunk
  world.run(500);
  const auto file = world.finish();
  const auto whole = bytes_of_file(file);
  const auto cut = world.files().write("cut.mcap", whole.substr(0, last_chunk_of(whole) + 100));
  const auto ticks = replay(cut).ticks;
  ASSERT_GE(ticks, 500u);
  ASSERT_LT(ticks, 1000u);
  const auto logged = [](const auto& call) {
    std::ostringstream lines;
    const auto before = spdlog::default_logger();
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines)));
    call();
    spdlog::set_default_logger(before);
    return lines.str();
  };
  EXPECT_THROW(rewind(cut, 1.0, {}), std::runtime_error);
  EXPECT_EQ(rewind(cut, 0.4, {}).world->tick_count(), 400);
  const auto to_the_end = [](const auto& of, double at_s) { return [of, at_s] { rewind(of, at_s, {}); }; };
  constexpr auto kEnd = std::numeric_limits<double>::infinity();
  EXPECT_NE(logged(to_the_end(cut, kEnd)).find("can be read up to"), std::string::npos);
  EXPECT_NE(logged(to_the_end(file, 1.001)).find("it ends at 1 s"), std::string::npos);
  EXPECT_EQ(logged(to_the_end(file, kEnd)), "");
  EXPECT_EQ(logged(to_the_end(file, 1.0)), "");
}

}  // namespace
}  // namespace visum::recording
