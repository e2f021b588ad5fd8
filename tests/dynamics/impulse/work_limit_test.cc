// A tick whose work meets its limit ends with what was reached: with no more energy, closed joints, finite
// numbers, the same bits each time, and the names of those that fell short.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/contact_models.h"

namespace visum::dynamics::testing {
namespace {

constexpr std::uint64_t kTiny = 1, kSmall = 20'000, kMedium = 500'000;

world::EngineSetting impulse(std::uint64_t limit, const char* solver = "direct") {
  world::EngineSetting setting;
  setting.name = "impulse";
  setting.solver = solver;
  setting.work_limit = limit;
  return setting;
}

// Boxes of 10 cm at these distances; below 0.1 they overlap.
void add_boxes(ModelBuilder& b, int side, int high, double apart, double above) {
  for (int k = 0; k < high; ++k)
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) {
        const double turn = 0.1 * k + 0.7 * i + 1.3 * j;
        b.add_box("box_" + std::to_string((k * side + i) * side + j), {0.1, 0.1, 0.1}, 1.0 + i,
                  at(apart * i, apart * j, 0.06 + above * k, 0.1 * turn, {0.3, 1, 0.2}));
      }
}

world::WorldModel pile(const world::EngineSetting& setting) {
  ModelBuilder b(setting);
  b.add_ground();
  add_boxes(b, 3, 3, 0.12, 0.12);
  return b.model;
}

world::WorldModel overlapping_boxes(const world::EngineSetting& setting) {
  ModelBuilder b(setting);
  b.add_ground();
  add_boxes(b, 3, 3, 0.05, 0.04);
  return b.model;
}

world::WorldModel wall(const world::EngineSetting& setting) {
  ModelBuilder b(setting);
  b.add_ground();
  for (int k = 0; k < 5; ++k)
    for (int i = 0; i < 5; ++i)
      b.add_box("brick_" + std::to_string(5 * k + i), {0.2, 0.1, 0.1}, 1.0,
                at(0.2 * i + 0.1 * (k % 2), 0, 0.05 + 0.1 * k));
  b.body(b.add_sphere("ball", 0.1, 5.0, at(0.5, -0.3, 0.3))).v_WB = {0, 4, 0};
  return b.model;
}

// Chains in a heap whose links overlap, so that contacts work against joints.
world::WorldModel wedged_chains(const world::EngineSetting& setting) {
  ModelBuilder b(setting);
  b.add_ground();
  for (int k = 0; k < 3; ++k) {
    BodyId last;
    for (int i = 0; i < 6; ++i) {
      const double x = 0.04 * i, y = 0.05 * k;
      const BodyId link =
          b.add_box("link_" + std::to_string(6 * k + i), {0.08, 0.08, 0.08}, 1.0 + i, at(x, y, 0.1));
      const auto kind = k == 0 ? world::JointKind::kBall : world::JointKind::kHinge;
      if (i > 0) b.add_joint("joint_" + std::to_string(6 * k + i), kind, last, link, {x, y, 0.1}, {0, 1, 0});
      last = link;
    }
  }
  return b.model;
}

double potential_energy(const Lab& lab) {
  double sum = 0.0;
  for (std::size_t i = 0; i < lab.model.bodies.size(); ++i)
    if (!lab.model.bodies[i].fixed)
      sum -= lab.model.bodies[i].mass_kg * lab.model.gravity.dot(lab.state.bodies[i].p_WC);
  return sum;
}

// Largest distance of a joint's two points, m.
double largest_gap(const Lab& lab) {
  double largest = 0.0;
  for (const world::Joint& joint : lab.model.joints) {
    const auto point = [&](BodyId id, const Pose& X) {
      const world::Body& body = lab.model.bodies[id.index()];
      const world::BodyState& now = lab.state.bodies[id.index()];
      return Eigen::Vector3d(now.p_WC + now.q_WB * (X.p - body.p_BC));
    };
    if (joint.parent.valid())
      largest = std::max(largest, (point(joint.parent, joint.X_PJ) - point(joint.child, joint.X_CJ)).norm());
  }
  return largest;
}

struct Case {
  const char* name;
  world::WorldModel (*make)(const world::EngineSetting&);
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

class LimitedTick : public ::testing::TestWithParam<std::tuple<Case, std::uint64_t>> {
 protected:
  world::WorldModel make(const char* solver = "direct") const {
    return std::get<0>(GetParam()).make(impulse(std::get<1>(GetParam()), solver));
  }
};

TEST_P(LimitedTick, GainsNoEnergyAndHoldsItsJoints) {
  Lab lab(make());
  double before = lab.kinetic_energy() + potential_energy(lab);
  const double scale = std::abs(before) + 1.0;
  int limited = 0;
  for (int tick = 0; tick < 300; ++tick) {
    const StepResult result = lab.step();
    ASSERT_TRUE(result.ok) << result.fault;
    const double now = lab.kinetic_energy() + potential_energy(lab);
    ASSERT_TRUE(std::isfinite(now)) << "tick " << tick;
    if (result.limited) {
      ++limited;
      ASSERT_LE(now, before + 1e-10 * scale) << "tick " << tick;
      ASSERT_LE(result.fell_short.size(), StepResult::kMostNamed);
      ASSERT_LE(result.work, std::get<1>(GetParam()));
    }
    ASSERT_LE(largest_gap(lab), 3e-5) << "tick " << tick;
    before = now;
  }
  if (std::get<1>(GetParam()) == kTiny) {
    EXPECT_EQ(limited, 300);
  }
}

TEST_P(LimitedTick, IsTheSameAgainAndAfterARestore) {
  Lab lab(make()), again(make()), restored(make());
  lab.run_ticks(40);
  again.run_ticks(40);
  EXPECT_EQ(lab.hash(), again.hash());
  restored.state = lab.state;
  lab.run_ticks(20);
  restored.run_ticks(20);
  EXPECT_EQ(lab.hash(), restored.hash());
}

TEST_P(LimitedTick, HoldsForTheIterativeSolverToo) {
  Lab lab(make("iterate"));
  double before = lab.kinetic_energy() + potential_energy(lab);
  const double scale = std::abs(before) + 1.0;
  for (int tick = 0; tick < 100; ++tick) {
    const StepResult result = lab.step();
    ASSERT_TRUE(result.ok) << result.fault;
    const double now = lab.kinetic_energy() + potential_energy(lab);
    ASSERT_TRUE(std::isfinite(now));
    if (result.limited) {
      ASSERT_LE(now, before + 1e-10 * scale) << "tick " << tick;
    }
    before = now;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, LimitedTick,
                         ::testing::Combine(::testing::Values(Case{"pile", pile}, Case{"wall", wall},
                                                              Case{"overlapping", overlapping_boxes},
                                                              Case{"chains", wedged_chains}),
                                            ::testing::Values(kTiny, kSmall, kMedium)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) +
                                  std::to_string(std::get<1>(test.param));
                         });

TEST(WorkLimit, AStackStandsThoughEachOfItsTicksIsLimited) {
  ModelBuilder b(impulse(kTiny));
  b.add_ground();
  for (int i = 0; i < 5; ++i)
    b.add_box("box_" + std::to_string(i), {0.1, 0.1, 0.1}, 1.0, at(0, 0, 0.05 + 0.1 * i));
  Lab lab(b.model);
  lab.run(2.0);
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(lab.body("box_" + std::to_string(i)).p_WC.z(), 0.05 + 0.1 * i, 1e-3);
}

// Nothing but gravity acts on their centre of mass, however hard they push each other apart.
TEST(WorkLimit, OverlappingBodiesFallAsTheyShould) {
  for (const std::uint64_t limit : {kTiny, kSmall, kMedium}) {
    ModelBuilder b(impulse(limit));
    add_boxes(b, 4, 4, 0.07, 0.07);
    Lab lab(b.model);
    const double before = potential_energy(lab);
    double weight = 0.0;
    for (const world::Body& body : lab.model.bodies) weight += 9.81 * body.mass_kg;
    int limited = 0;
    for (int tick = 0; tick < 100; ++tick) limited += lab.step().limited;
    EXPECT_GT(limited, limit == kMedium ? 0 : 90);
    EXPECT_NEAR((before - potential_energy(lab)) / weight, 0.5 * 9.81 * 0.1 * 0.1, 0.005)
        << "limit " << limit;
  }
}

// It touches nothing, so it flies on as it would.
TEST(WorkLimit, ABodyInFlightFeelsNothingOfALimit) {
  ModelBuilder limited(impulse(kTiny)), free(impulse(0));
  for (ModelBuilder* b : {&limited, &free})
    b->add_box("box", {0.1, 0.2, 0.3}, 1.0, at(0, 0, 5, 0.3, {1, 1, 0}));
  Lab a(limited.model), c(free.model);
  for (Lab* lab : {&a, &c}) lab->body("box").w_WB = {1, 2, 3};
  a.run(0.2);
  c.run(0.2);
  EXPECT_EQ(a.body("box").p_WC, c.body("box").p_WC);
  EXPECT_EQ(a.body("box").q_WB.coeffs(), c.body("box").q_WB.coeffs());
}

TEST(WorkLimit, NamesBodiesThatFellShort) {
  Lab lab(overlapping_boxes(impulse(kTiny)));
  std::size_t named = 0;
  for (int tick = 0; tick < 20; ++tick) {
    const StepResult result = lab.step();
    ASSERT_TRUE(result.limited);
    named = std::max(named, result.fell_short.size());
    for (const BodyId id : result.fell_short) EXPECT_NE(lab.model.bodies[id.index()].name, "ground");
  }
  EXPECT_GT(named, 0u);
  EXPECT_LE(named, StepResult::kMostNamed);
}

TEST(WorkLimit, ADriveHoldsItsLoadInLimitedTicks) {
  ModelBuilder b(impulse(kTiny));
  const BodyId arm = b.add_box("arm", {0.5, 0.05, 0.05}, 2.0, at(0.25, 0, 1));
  b.add_joint("hinge", world::JointKind::kHinge, {}, arm, {0, 0, 1}, {0, 1, 0});
  Lab lab(b.model);
  lab.drive("hinge") = {.target_velocity = 0.5, .compliance = 1e-4, .max_effort = 100.0};
  lab.run(0.5);
  EXPECT_NEAR(lab.joint("hinge").velocity, 0.5, 1e-2);
  EXPECT_NEAR(lab.joint("hinge").position, 0.25, 1e-2);
}

// The same with GCC and Clang, and with each kind of kernels.
TEST(WorkLimit, GoldenBits) {
  Lab lab(wedged_chains(impulse(kSmall)));
  lab.run_ticks(50);
  EXPECT_EQ(lab.hash(), 0xf62f69dff413fba5u);
}

TEST(WorkLimit, IsMetByNothingThatIsUsual) {
  Lab lab(pile(impulse(0)));
  for (int tick = 0; tick < 300; ++tick) ASSERT_FALSE(lab.step().limited);
}

// Free bodies take answers that come near before a tick must be limited. Those gain no energy either, beyond
// what lifts overlapping bodies apart.
TEST(WorkLimit, APileNearItTakesInexactAnswersFirst) {
  constexpr double kLifted = 0.02, kLiftedInATick = 5e-3;  // J
  Lab lab(physics::piles(impulse(200'000), 1e-3, 1, 60));
  double before = lab.kinetic_energy() + potential_energy(lab), least = before;
  int inexact = 0, limited = 0;
  for (int tick = 0; tick < 1500; ++tick) {
    const StepResult result = lab.step();
    ASSERT_TRUE(result.ok) << result.fault;
    limited += result.limited;
    inexact += result.warned && !result.limited;
    const double now = lab.kinetic_energy() + potential_energy(lab);
    ASSERT_LE(now, least + kLifted) << "tick " << tick;
    ASSERT_LE(now, before + kLiftedInATick) << "tick " << tick;
    before = now;
    least = std::min(least, now);
  }
  EXPECT_GE(inexact, 10);
  EXPECT_LT(limited, inexact);
}

// It has 10,000 contacts, and its first tick needs 51 million units: more than a small scene may take.
TEST(WorkLimit, AWallOfMoreThanAThousandBricksStaysWithinIt) {
  Lab lab(physics::falling_wall(impulse(0), 1e-3, 36));
  for (int tick = 0; tick < 3; ++tick) {
    const StepResult result = lab.step();
    EXPECT_FALSE(result.limited);
    EXPECT_FALSE(result.warned);
    if (tick == 0) {
      EXPECT_GT(result.work, 50'000'000u);
    }
  }
  for (const auto& body : lab.state.bodies) EXPECT_LT(body.v_WC.norm(), 1e-4);
}

}  // namespace
}  // namespace visum::dynamics::testing
