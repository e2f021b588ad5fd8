// Islands are found from what connects bodies, and each is solved as if it were alone in the world.
#include "server/dynamics/impulse/islands.h"

#include <gtest/gtest.h>

#include "server/dynamics/impulse/plant.h"
#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"

namespace visum::dynamics::testing {
namespace {

using Indices = std::vector<std::size_t>;

Indices listed(std::span<const std::size_t> members) {
  return {members.begin(), members.end()};
}

impulse::Touch touch_of(int a, int b) {
  impulse::Touch touch;
  touch.a = a;
  touch.b = b;
  return touch;
}

// Bodies 0 and 1 make a hinge, a spring joins 2 and 3, and 4 to 6 are free.
ModelBuilder seven_bodies(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  for (int i = 0; i < 7; ++i) b.add_sphere("ball_" + std::to_string(i), 0.1, 1.0, at(i, 0, 1));
  b.add_joint("hinge", world::JointKind::kHinge, {0}, {1}, {0.5, 0, 1}, Eigen::Vector3d::UnitY());
  b.add_joint("spring", world::JointKind::kSpring, {2}, {3}, {2.5, 0, 1}, Eigen::Vector3d::UnitZ());
  return b;
}

TEST(Islands, JoinWhatJointsSpringsAndContactsConnect) {
  const ModelBuilder b = seven_bodies(physics::engine_row("impulse").setting);
  impulse::Plant plant(b.model, 0);
  impulse::Islands& islands = plant.islands;
  ASSERT_EQ(islands.size(), 2u);
  EXPECT_EQ(listed(islands.mechanisms(0)), Indices{0});
  EXPECT_EQ(listed(islands.springs(1)), Indices{0});
  // 6 lies on the ground and on 4, and 5 touches the spring. Only bodies 0 and 1 stay for themselves.
  plant.touches = {touch_of(6, -1), touch_of(5, 3), touch_of(4, 6)};
  islands.find(plant, {});
  ASSERT_EQ(islands.size(), 3u);
  EXPECT_TRUE(islands.touches(0).empty());
  EXPECT_EQ(listed(islands.touches(1)), Indices{1});
  EXPECT_EQ(listed(islands.springs(1)), Indices{0});
  EXPECT_EQ(listed(islands.touches(2)), (Indices{0, 2}));
  EXPECT_EQ(listed(islands.bodies(0)), (Indices{0, 1}));
  EXPECT_EQ(listed(islands.bodies(1)), (Indices{2, 3, 5}));
  EXPECT_EQ(listed(islands.bodies(2)), (Indices{4, 6}));
  // 3 and 1 meet: everything jointed is one island. Sleeping contacts belong to none.
  plant.touches = {touch_of(6, -1), touch_of(1, 3)};
  plant.touches[0].asleep = true;
  islands.find(plant, {});
  ASSERT_EQ(islands.size(), 1u);
  EXPECT_EQ(listed(islands.mechanisms(0)), Indices{0});
  EXPECT_EQ(listed(islands.springs(0)), Indices{0});
  EXPECT_EQ(listed(islands.touches(0)), Indices{1});
  plant.touches.clear();
  islands.find(plant, {});
  EXPECT_EQ(islands.size(), 2u);
}

TEST(Islands, ABodyThatAWrenchPushesIsOne) {
  const ModelBuilder b = seven_bodies(physics::engine_row("impulse").setting);
  impulse::Plant plant(b.model, 0);
  impulse::Islands& islands = plant.islands;
  std::vector<Wrench> wrenches(3);
  wrenches[0].body = {5};
  wrenches[1].body = {1};
  wrenches[2].body = {5};
  islands.find(plant, wrenches);
  ASSERT_EQ(islands.size(), 3u);
  EXPECT_EQ(listed(islands.wrenches(0)), Indices{1});
  EXPECT_TRUE(islands.wrenches(1).empty());
  EXPECT_EQ(listed(islands.wrenches(2)), (Indices{0, 2}));
  EXPECT_EQ(listed(islands.bodies(2)), Indices{5});
  // They are gone in the next tick.
  islands.find(plant, {});
  ASSERT_EQ(islands.size(), 2u);
  EXPECT_TRUE(islands.wrenches(0).empty());
}

// Boxes that fall on one another and bounce a little, beside a loose chain that falls onto its own box.
constexpr int kBoxes = 6;
ModelBuilder heap_and_chain(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  const world::SurfaceId bouncy = b.add_surface(0.4, 0.3);
  b.add_ground(bouncy);
  for (int i = 0; i < kBoxes; ++i)
    b.add_box("box_" + std::to_string(i), {0.2, 0.15, 0.1}, 1.0,
              at(0.05 * (i % 3), 0.02 * i, 0.1 + 0.2 * i, 0.4 * i, {1, 2, 3}), bouncy);
  BodyId last;
  for (int i = 0; i < 3; ++i) {
    const BodyId link =
        b.add_box("link_" + std::to_string(i), {0.3, 0.05, 0.05}, 0.5, at(0.3 * i, 3.0, 0.6), bouncy);
    if (last.valid())
      b.add_joint("hinge_" + std::to_string(i), world::JointKind::kHinge, last, link,
                  {0.3 * i - 0.15, 3.0, 0.6}, Eigen::Vector3d::UnitY());
    last = link;
  }
  b.add_box("below", {0.2, 0.2, 0.2}, 2.0, at(0.2, 3.0, 0.1));
  return b;
}

bool is_same(const world::BodyState& a, const world::BodyState& b) {
  return a.p_WC == b.p_WC && a.q_WB.coeffs() == b.q_WB.coeffs() && a.v_WC == b.v_WC && a.w_WB == b.w_WB;
}

class IslandsAlone : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Solvers, IslandsAlone, ::testing::Values("impulse", "impulse-iterate"),
                         [](const auto& info) { return info.index == 0 ? "direct" : "iterate"; });

// The contacts of one heap are settled, solved and at rest by themselves, to the last bit.
TEST_P(IslandsAlone, MoveAsIfNothingElseWereInTheWorld) {
  const auto setting = physics::engine_row(GetParam()).setting;
  ModelBuilder alone = heap_and_chain(setting), crowded = heap_and_chain(setting);
  for (int i = 0; i < 5; ++i)
    crowded.add_box("other_" + std::to_string(i), {0.2, 0.2, 0.2}, 1.0 + i,
                    at(8.0 + 0.03 * i, 0, 0.15 + 0.25 * i, 0.7 * i, {2, 1, 3}));
  crowded.body(crowded.add_sphere("roller", 0.1, 1.0, at(-5, 0, 0.1))).v_WB = {0.0, 1.0, 0.0};
  Lab one(alone.model), other(crowded.model);
  for (int tick = 0; tick < 1500; ++tick) {
    ASSERT_TRUE(one.step().ok);
    ASSERT_TRUE(other.step().ok);
    for (std::size_t i = 0; i < one.state.bodies.size(); ++i)
      ASSERT_TRUE(is_same(one.state.bodies[i], other.state.bodies[i]))
          << "body '" << one.model.bodies[i].name << "', tick " << tick;
  }
}

}  // namespace
}  // namespace visum::dynamics::testing
