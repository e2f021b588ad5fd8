#include "server/dynamics/kinds/engine_kinds.h"
#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {
namespace {

class FreeMotion : public Contract {};
VISUM_INSTANTIATE_CONTRACT(FreeMotion);

struct Parabola {
  Eigen::Vector3d p, v, g;
  Eigen::Vector3d position(double t) const { return p + v * t + 0.5 * g * t * t; }
  Eigen::Vector3d velocity(double t) const { return v + g * t; }
};

TEST_P(FreeMotion, FallsOnAParabola) {
  auto b = builder();
  const BodyId box = b.add_box("box", {0.1, 0.2, 0.3}, 2.0, at(1, 2, 3, 0.4, {1, 2, 3}));
  b.body(box).v_WB = {1.0, -2.0, 5.0};
  const Parabola exact{{1, 2, 3}, {1, -2, 5}, b.model.gravity};
  Lab lab(b.model);
  lab.run(1.0);
  EXPECT_LT((lab.body("box").p_WC - exact.position(1.0)).norm(), accuracy().free_fall_m);
  EXPECT_LT((lab.body("box").v_WC - exact.velocity(1.0)).norm(), 1e-10);
}

TEST_P(FreeMotion, FallsWithItsCentreOfMassWhereverTheLinkFrameIs) {
  auto b = builder();
  const BodyId box = b.add_box("box", {0.1, 0.2, 0.3}, 2.0, at(0, 0, 0, 0.7, {0, 0, 1}));
  b.body(box).p_BC = {0.5, 0, 0};
  b.body(box).w_WB = {0, 0, 3.0};
  b.model.gravity.setZero();
  Lab lab(b.model);
  const Eigen::Vector3d v = lab.body("box").v_WC;
  EXPECT_NEAR(v.norm(), 1.5, 1e-12);
  lab.run(0.5);
  EXPECT_LT((lab.body("box").v_WC - v).norm(), 1e-10);
  EXPECT_NEAR(lab.body("box").w_WB.z(), 3.0, 1e-10);
}

TEST_P(FreeMotion, AWrenchActsAtTheCentreOfMassForOneTickAtATime) {
  auto b = builder();
  const BodyId box = b.add_box("box", {0.2, 0.2, 0.2}, 2.0, at(0, 0, 0));
  b.model.gravity.setZero();
  Lab lab(b.model);
  lab.wrenches = {{box, {4.0, 0, 0}, {0, 0, 0.02}}};
  lab.run(0.5);
  lab.wrenches.clear();
  lab.run(0.5);
  EXPECT_NEAR(lab.body("box").v_WC.x(), 4.0 / 2.0 * 0.5, 1e-9);
  const double inertia = 2.0 * (0.04 + 0.04) / 12.0;
  EXPECT_NEAR(lab.body("box").w_WB.z(), 0.02 / inertia * 0.5, 1e-9);
}

TEST_P(FreeMotion, ATumblingBodyGainsNoEnergy) {
  auto b = builder();
  const BodyId box = b.add_box("box", {0.1, 0.4, 0.9}, 10.0, at(0, 0, 0));
  b.body(box).w_WB = {0.1, 5.0, 0.1};  // the unstable axis
  b.model.gravity.setZero();
  Lab lab(b.model);
  const double before = lab.kinetic_energy();
  lab.run(10.0);
  EXPECT_LE(lab.kinetic_energy(), before * 1.001);
}

TEST(Engines, EveryEngineHasARow) {
  ASSERT_FALSE(engine_kinds().empty());
  for (const EngineKind& kind : engine_kinds()) {
    EXPECT_TRUE(std::any_of(rows().begin(), rows().end(), [&](const Row& row) {
      return row.engine.name == kind.name;
    })) << kind.name;
  }
}

// The text with which the engine is refused; empty if it is not.
std::string refusal_of(const world::EngineSetting& setting) {
  world::WorldModel model;
  model.engines.push_back(setting);
  try {
    make_engine(model, 0);
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

TEST(Engines, AnUnknownEngineIsRefusedWithTheNamesOfThoseThereAre) {
  EXPECT_EQ(refusal_of({"bullet"}), "there is no engine 'bullet'; there are: impulse, ode");
  EXPECT_EQ(refusal_of({"impulze"}), "there is no engine 'impulze'; did you mean 'impulse'?");
}

TEST(Engines, AnUnknownStepIsRefusedWithTheNamesOfThoseThereAre) {
  EXPECT_EQ(refusal_of({"ode", "slow"}), "engine 'ode': there is no step 'slow'; there are: world, quick");
}

TEST(Engines, AnUnknownSolverIsRefusedWithTheNamesOfThoseThereAre) {
  world::EngineSetting setting{"impulse"};
  setting.solver = "fast";
  EXPECT_EQ(refusal_of(setting), "engine 'impulse': there is no solver 'fast'; there are: direct, iterate");
}

}  // namespace
}  // namespace visum::dynamics::testing
