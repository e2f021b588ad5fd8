// Some ticks of a recording have the hash of the state; a replay says what it knows of the others.
#include <gtest/gtest.h>

#include <set>
#include <span>
#include <vector>

#include "protocol/recording/records.h"
#include "server/recording/replay.h"
#include "tests/recording/forge.h"
#include "tests/recording/messages.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

std::vector<Tick> ticks_of(const std::filesystem::path& file) {
  std::vector<Tick> ticks;
  for (const auto& message : messages_of(file, "/ticks")) {
    TickMessage read;
    EXPECT_TRUE(read.decode(message.data));
    ticks.push_back({read.tick.tick, read.tick.era, read.tick.sim_time_ns, read.tick.state_hash, {}});
  }
  return ticks;
}

std::set<std::int64_t> hashed(const std::vector<Tick>& ticks) {
  std::set<std::int64_t> numbers;
  for (const auto& tick : ticks)
    if (tick.state_hash != kNoHash) numbers.insert(tick.tick);
  return numbers;
}

TEST(HashedTicks, EachTenthAndTheLast) {
  RecordedWorld world;
  world.run(33);
  const auto ticks = ticks_of(world.finish());
  ASSERT_EQ(ticks.size(), 33u);
  EXPECT_EQ(hashed(ticks), (std::set<std::int64_t>{10, 20, 30, 33}));
  EXPECT_EQ(ticks.back().state_hash, world->state_hash());
}

TEST(HashedTicks, NotTheLastWhereAnInputFollowedIt) {
  RecordedWorld world;
  world.run(12);
  world->write_inputs(0, 0, std::vector{0.7});
  EXPECT_EQ(hashed(ticks_of(world.finish())), (std::set<std::int64_t>{10}));
}

// A state has the hash of the tick before it, also where that is no tenth one.
TEST(HashedTicks, ThoseBeforeAState) {
  RecordedWorld world;
  const auto second = 1'000'000'000 / world->model().tick_ns;
  world.run(5);
  const auto snapshot = world->take_snapshot();
  world.run(3);
  ASSERT_TRUE(world->restore_snapshot(snapshot).done());
  world.run(static_cast<int>(second));
  const auto file = world.finish();
  const auto states = messages_of(file, "/states");
  ASSERT_EQ(states.size(), 1u);
  State state;
  ASSERT_TRUE(decode(states[0].data, state));
  ASSERT_NE(state.tick % 10, 0);
  EXPECT_TRUE(hashed(ticks_of(file)).contains(state.tick));
  EXPECT_TRUE(replay(file).equal);
}

// The world is then somewhere within the tick after it.
TEST(HashedTicks, NotTheLastBeforeATickThatWasAbandoned) {
  RecordedWorld world;
  world.run(12);
  world->working().begin(12);
  EXPECT_EQ(hashed(ticks_of(world.finish())), (std::set<std::int64_t>{10}));
}

// A ball shows in no port.
TEST(HashedTicks, AReplaySaysSinceWhenAHiddenStateMayBeAnother) {
  RecordedWorld world;
  ASSERT_TRUE(world->add_body(kBall).done());
  const auto ball = world->model().find_body("ball");
  world.run(13);
  ASSERT_TRUE(world->push({{ball, {1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, 14}).done());
  world.run(20);
  const auto forged = world.files().folder() / "forged.mcap";
  forge(world.finish(), forged, "/inputs", 1, [&](std::vector<std::byte>& data) {
    data.clear();
    encode(TimedInput{13, 1, PushBody{static_cast<std::int32_t>(ball.value), {1.0, 0.1, 0.0}, {}, 14}}, data);
  });
  const auto result = replay(forged);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.difference.tick, 20);
  EXPECT_EQ(result.ticks, 19u);
  EXPECT_EQ(result.difference.what, "the state is another one, as it may have been for 10 ticks");
  EXPECT_NE(result.difference.recorded_hash, result.difference.replayed_hash);
  EXPECT_TRUE(result.difference.ports.empty());
}

}  // namespace
}  // namespace visum::recording
