// Bodies of two engines in one world share loads where they touch, in either order of the engines.
#include <gmock/gmock.h>

#include "tests/dynamics/contract/rows.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::dynamics::testing {
namespace {

using Eigen::Vector3d;
using world::JointKind;

// A body rests so deep in one of the other engine. Impulses are sought until velocities agree to 1e-6 m/s; in
// a tick of 1 ms that is 0.05 N for a body of 50 kg, or this share of its weight.
constexpr double kOverlapM = 1e-5, kForceShare = 1e-4;

class Coupled : public ::testing::TestWithParam<bool> {
 protected:
  // The world's first engine moves everything but what `second` is given to.
  static ModelBuilder builder() {
    world::EngineSetting ode, impulse;
    ode.name = "ode";
    impulse.name = "impulse";
    ModelBuilder b(GetParam() ? ode : impulse);
    b.model.engines.push_back(GetParam() ? impulse : ode);
    return b;
  }
};
INSTANTIATE_TEST_SUITE_P(BothOrders, Coupled, ::testing::Bool(), [](const auto& info) {
  return std::string(info.param ? "OdeFirst" : "ImpulseFirst");
});

// A raft on a spring and a damper, with a load that the other engine moves.
ModelBuilder raft(ModelBuilder b, double load_kg, double stiffness) {
  const BodyId raft = b.add_box("raft", {1.0, 1.0, 0.1}, 1.0, at(0, 0, 1.0));
  b.add_joint("guide", JointKind::kSlider, {}, raft, {0, 0, 1.0}, Vector3d::UnitZ());
  auto& spring = b.add_joint("spring", JointKind::kSpring, {}, raft, {0, 0, 0}, Vector3d::UnitZ());
  spring.X_CJ.p = Vector3d::Zero();
  spring.stiffness = stiffness;
  spring.damping = 0.5 * std::sqrt(stiffness * load_kg);
  spring.rest = 1.0;
  b.body(b.add_box("load", {0.4, 0.4, 0.2}, load_kg, at(0, 0, 1.15))).engine = 1;
  return b;
}

// ODE has no springs, so the raft is always moved by `impulse`.
TEST(CoupledRaft, AHeavyLoadOnALightRaftRestsWhereOneEnginePutsIt) {
  world::EngineSetting ode, impulse;
  ode.name = "ode";
  impulse.name = "impulse";
  constexpr double kLoad = 50.0, kSag = 0.05;
  const double stiffness = (kLoad + 1.0) * 9.81 / kSag;
  for (const bool swapped : {false, true}) {
    ModelBuilder b(impulse);
    b.model.engines.push_back(ode);
    b = raft(b, kLoad, stiffness);
    if (swapped) {
      std::swap(b.model.engines[0], b.model.engines[1]);
      for (auto& body : b.model.bodies) body.engine = 1 - body.engine;
    }
    b.model.gravity = {0.0, 0.0, -9.81};
    Lab lab(b.model);
    lab.run(5.0);
    EXPECT_NEAR(1.0 - lab.body("raft").p_WC.z(), kSag, 1e-6) << swapped;
    EXPECT_NEAR(lab.body("load").p_WC.z() - lab.body("raft").p_WC.z(), 0.15, 2.0 * kOverlapM);
    EXPECT_NEAR(lab.normal_force_between("raft", "load"), kLoad * 9.81, kForceShare * kLoad * 9.81);
    EXPECT_LT(lab.body("load").v_WC.norm(), 1e-5);
    const int warned = lab.warned_ticks;
    lab.run(0.5);
    EXPECT_EQ(lab.warned_ticks, warned) << "at rest the engines agree";
  }
}

// The load answers as if the lower box did not move, fifty times as hard as both would if they were free.
TEST_P(Coupled, AHeavyBoxStandsOnALightOneOnTheGround) {
  auto b = builder();
  b.add_ground();
  b.add_box("low", {0.4, 0.4, 0.1}, 1.0, at(0, 0, 0.05));
  b.body(b.add_box("high", {0.3, 0.3, 0.2}, 50.0, at(0, 0, 0.2))).engine = 1;
  Lab lab(b.model);
  lab.run(2.0);
  EXPECT_NEAR(lab.body("high").p_WC.z(), 0.2, 4.0 * kOverlapM);
  EXPECT_LT(lab.body("high").v_WC.norm(), 1e-5);
  EXPECT_LT(lab.body("high").p_WC.head<2>().norm(), 1e-6);
  EXPECT_NEAR(lab.normal_force_between("low", "high"), 50.0 * 9.81, kForceShare * 50.0 * 9.81);
  double ground = 0.0;
  for (const auto& contact : lab.contacts)
    if (lab.model.bodies[contact.body_a.index()].fixed) ground += contact.normal_force_n;
  EXPECT_NEAR(ground, 51.0 * 9.81, kForceShare * 51.0 * 9.81) << "the ground carries both";
}

TEST_P(Coupled, AStackOfAlternatingEnginesStands) {
  auto b = builder();
  b.add_ground();
  for (int i = 0; i < 4; ++i)
    b.body(b.add_box("box_" + std::to_string(i), {0.2, 0.2, 0.2}, 1.0 + i, at(0, 0, 0.1 + 0.2 * i))).engine =
        i % 2;
  Lab lab(b.model);
  lab.run(2.0);
  for (int i = 0; i < 4; ++i)
    EXPECT_LT((lab.body("box_" + std::to_string(i)).p_WC - Vector3d(0, 0, 0.1 + 0.2 * i)).norm(), 1e-3) << i;
}

TEST_P(Coupled, AHitKeepsMomentumAndBounces) {
  auto b = builder();
  b.model.gravity.setZero();
  const auto bouncy = b.add_surface(0.3, 0.5);
  const BodyId light = b.add_sphere("light", 0.1, 1.0, at(-0.3, 0.03, 0), bouncy);
  const BodyId heavy = b.add_sphere("heavy", 0.1, 7.0, at(0.3, 0, 0), bouncy);
  b.body(light).v_WB = {3.0, 0.0, 0.0};
  b.body(light).w_WB = {0.0, 0.0, 20.0};
  b.body(heavy).engine = 1;
  Lab lab(b.model);
  const Vector3d before = physics::momentum_of(lab.model, lab.state),
                 spin = physics::angular_momentum_of(lab.model, lab.state);
  lab.run(0.5);
  EXPECT_LT((physics::momentum_of(lab.model, lab.state) - before).norm(), 1e-10);
  EXPECT_LT((physics::angular_momentum_of(lab.model, lab.state) - spin).norm(), 5e-3 * spin.norm());
  const Vector3d apart = lab.body("heavy").v_WC - lab.body("light").v_WC;
  EXPECT_NEAR(apart.x(), 0.5 * 3.0, 0.01);
}

// A crate on a sled: pulled by less than friction gives they go together, pulled by more the crate slides.
TEST_P(Coupled, FrictionDragsTheOtherEnginesBody) {
  for (const double pull_n : {2.0, 20.0}) {
    auto b = builder();
    const auto rough = b.add_surface(0.5, 0.0), ice = b.add_surface(0.0, 0.0);
    b.add_ground(ice);
    b.add_box("sled", {2.0, 0.6, 0.1}, 1.0, at(0, 0, 0.05), rough);
    const BodyId crate = b.add_box("crate", {0.2, 0.2, 0.2}, 1.0, at(0, 0, 0.2), rough);
    b.body(crate).engine = 1;
    Lab lab(b.model);
    lab.run(0.2);
    lab.wrenches = {{crate, {pull_n, 0, 0}, {0, 0, 0}}};
    lab.run(0.2);
    const double together = pull_n / 2.0, friction = 0.5 * 9.81;
    const bool slides = together > friction;
    EXPECT_NEAR(lab.body("sled").v_WC.x(), 0.2 * (slides ? friction : together), 1e-5) << pull_n;
    EXPECT_NEAR(lab.body("crate").v_WC.x(), 0.2 * (slides ? pull_n - friction : together), 1e-5) << pull_n;
    const double momentum = lab.body("sled").v_WC.x() + lab.body("crate").v_WC.x();
    EXPECT_NEAR(momentum, 0.2 * pull_n, 1e-10 * pull_n);
  }
}

TEST_P(Coupled, ARestoredWorldGoesOnWithTheSameBits) {
  auto b = builder();
  b.add_ground();
  b.add_box("low", {0.4, 0.4, 0.1}, 1.0, at(0, 0, 0.06));
  b.body(b.add_box("high", {0.3, 0.3, 0.2}, 9.0, at(0.05, 0, 0.23, 0.2, {0, 1, 0}))).engine = 1;
  Lab lab(b.model), again(b.model);
  lab.run_ticks(150);
  std::string fault;
  load(lab.bytes(), again.model, again.state, fault);
  ASSERT_EQ(fault, "");
  EXPECT_FALSE(again.state.coupling.empty()) << "they touch";
  for (Lab* one : {&lab, &again}) one->run_ticks(150);
  EXPECT_EQ(lab.hash(), again.hash());
}

}  // namespace
}  // namespace visum::dynamics::testing
