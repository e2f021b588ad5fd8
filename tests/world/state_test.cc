#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <set>

#include "server/world/world_state.h"
#include "tests/world/model.h"

namespace visum::world::testing {
namespace {

WorldState full_state() {
  WorldState state = initial_state(good_model());
  state.random = {1, 2, 3, 4};
  state.engines[0] = {std::byte{1}, std::byte{2}};
  return state;
}

std::uint64_t hash_of(const WorldState& state) {
  std::vector<std::byte> bytes;
  save(state, bytes);
  return hash_bytes(bytes);
}

TEST(StateHash, ChangesWithEveryField) {
  const std::vector<std::function<void(WorldState&)>> changes{
      [](WorldState& s) { s.tick = 1; },
      [](WorldState& s) { s.bodies[3].p_WC.x() += 1e-12; },
      [](WorldState& s) { s.bodies[3].p_WC.y() += 1e-12; },
      [](WorldState& s) { s.bodies[3].p_WC.z() = -0.0; },
      [](WorldState& s) { s.bodies[3].q_WB.w() -= 1e-16; },
      [](WorldState& s) { s.bodies[3].q_WB.x() = 1e-300; },
      [](WorldState& s) { s.bodies[3].q_WB.y() = 1e-300; },
      [](WorldState& s) { s.bodies[3].q_WB.z() = 1e-300; },
      [](WorldState& s) { s.bodies[3].v_WC.x() = 1e-300; },
      [](WorldState& s) { s.bodies[3].v_WC.z() = 1e-300; },
      [](WorldState& s) { s.bodies[3].w_WB.x() = 1e-300; },
      [](WorldState& s) { s.bodies[3].w_WB.z() = 1e-300; },
      [](WorldState& s) { s.bodies[0].w_WB.z() = 1e-300; },
      [](WorldState& s) { s.joints[1].position = 1e-300; },
      [](WorldState& s) { s.joints[1].velocity = 1e-300; },
      [](WorldState& s) { s.joints[1].effort = 1e-300; },
      [](WorldState& s) { s.random[3] = 5; },
      [](WorldState& s) { s.random.push_back(0); },
      [](WorldState& s) { s.engines[0][1] = std::byte{3}; },
      [](WorldState& s) { std::swap(s.engines[0], s.engines[1]); },
      [](WorldState& s) { s.engines.emplace_back(); },
  };
  std::set<std::uint64_t> seen{hash_of(full_state())};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    WorldState state = full_state();
    changes[i](state);
    EXPECT_TRUE(seen.insert(hash_of(state)).second) << "change " << i << " leaves the hash as it was";
  }
}

TEST(StateHash, IsThatOfTheBytesAlone) {
  const WorldState state = full_state();
  EXPECT_EQ(hash_of(state), hash_of(WorldState(state)));
}

TEST(StateHash, IsXxh64) {
  // The hash of no bytes with seed 0, as in xxHash's specification.
  EXPECT_EQ(hash_bytes({}), 0xef46db3751d8e999ull);
}

TEST(Save, AppendsToWhatIsThere) {
  std::vector<std::byte> bytes{std::byte{7}}, alone;
  save(full_state(), bytes);
  save(full_state(), alone);
  ASSERT_EQ(bytes.size(), alone.size() + 1);
  EXPECT_EQ(bytes[0], std::byte{7});
}

TEST(Save, HoldsNothingButTheFields) {
  const WorldState state = full_state();
  std::vector<std::byte> bytes;
  save(state, bytes);
  // Tick and lengths; that of `coupling` is there, since there are two engines.
  const std::size_t lists = 8 * (1 + 4 + state.engines.size() + 1);
  EXPECT_EQ(bytes.size(), lists + 13 * 8 * state.bodies.size() + 3 * 8 * state.joints.size() + 4 * 8 + 2);
}

TEST(Load, RefusesATickWhoseTimeCannotBeCounted) {
  const WorldModel model = good_model();
  const std::int64_t last = std::numeric_limits<std::int64_t>::max() / model.tick_ns / 2;
  for (const std::int64_t tick : {std::int64_t{0}, last, last + 1, std::int64_t{-1}}) {
    WorldState state = full_state(), loaded;
    state.tick = tick;
    state.engines.resize(model.engines.size());
    std::vector<std::byte> bytes;
    save(state, bytes);
    std::string fault;
    load(bytes, model, loaded, fault);
    EXPECT_EQ(fault, tick >= 0 && tick <= last ? "" : "the state is not one of this world") << tick;
  }
}

TEST(Sanity, AGoodStateIsSane) {
  std::string offender = "nobody";
  EXPECT_TRUE(is_sane(good_model(), full_state(), &offender));
  EXPECT_EQ(offender, "nobody");
  EXPECT_TRUE(is_sane(good_model(), full_state(), nullptr));
}

TEST(Sanity, NamesTheFirstOffender) {
  const std::vector<std::pair<std::function<void(WorldState&, double)>, const char*>> offences{
      {[](WorldState& s, double x) { s.bodies[2].p_WC.y() = x; }, "body 'link_2' has a position"},
      {[](WorldState& s, double x) { s.bodies[2].q_WB.z() = x; }, "body 'link_2' has a quaternion"},
      {[](WorldState& s, double x) { s.bodies[2].v_WC.x() = x; }, "body 'link_2' has a velocity"},
      {[](WorldState& s, double x) { s.bodies[2].w_WB.x() = x; }, "body 'link_2' has an angular velocity"},
  };
  for (const auto& [spoil, words] : offences) {
    for (const double value : {kNan, kInf, -kInf, 1.1e6, -1e300}) {
      WorldState state = full_state();
      spoil(state, value);
      std::string offender;
      EXPECT_FALSE(is_sane(good_model(), state, &offender));
      EXPECT_THAT(offender, ::testing::HasSubstr(words));
      EXPECT_FALSE(is_sane(good_model(), state, nullptr));
    }
  }
}

TEST(Sanity, LooksAtJointsToo) {
  WorldState state = full_state();
  state.joints[1].effort = kNan;
  std::string offender;
  EXPECT_FALSE(is_sane(good_model(), state, &offender));
  EXPECT_THAT(offender, ::testing::HasSubstr("joint 'slider'"));
}

}  // namespace
}  // namespace visum::world::testing
