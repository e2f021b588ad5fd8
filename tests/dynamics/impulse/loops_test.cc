// Closed loops: their joints are foreseen, some rows follow from others, drives and stops act on axes that
// close them, and near the line they lose their grip.
#include <gtest/gtest.h>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::dynamics {
namespace {

using Eigen::Vector3d;
using testing::Lab;

world::EngineSetting setting(const char* row = "impulse") {
  return physics::engine_row(row).setting;
}

world::Joint& joint(world::WorldModel& model, const char* name) {
  return model.joints[static_cast<std::size_t>(model.find_joint(name).index())];
}

void limit(world::Joint& joint, double lower, double upper) {
  joint.limited = true;
  joint.lower = lower;
  joint.upper = upper;
}

// Two four-bars that stand at rest, turned by an angle against the gravity's direction, which keeps them
// there.
world::WorldModel resting_bars(double angle) {
  world::WorldModel model = physics::four_bars(setting(), 1e-3, 2);
  const Vector3d along(std::sin(angle), 0.0, std::cos(angle));
  for (world::Body& body : model.bodies) {
    body.v_WB.setZero();
    body.w_WB.setZero();
    if (body.name.starts_with('r'))
      body.X_WB.q = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
    else
      body.X_WB.p += along - Vector3d::UnitZ();
  }
  model.gravity = 9.81 * along;
  return model;
}

// The largest gap in so many ticks.
double most_apart(Lab& lab, int ticks) {
  double most = 0.0;
  for (int i = 0; i < ticks; ++i) {
    EXPECT_TRUE(lab.step().ok) << i;
    most = std::max(most, physics::max_gap(lab.model, lab.state));
  }
  return most;
}

// Three cranks of 1 m on the ground, side by side, and a rod on top of all three: one loop too many.
class Cranks {
 public:
  explicit Cranks(const world::EngineSetting& engine) {
    model.tick_ns = 1'000'000;
    model.engines.push_back(engine);
    model.surfaces.push_back({"default"});
    model.gravity = {0.0, 0.0, 9.81};
    const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ();
    std::array<int, 3> cranks{};
    for (int i = 0; i < 3; ++i) {
      cranks[static_cast<std::size_t>(i)] = add_rod("crank_" + std::to_string(i), i * x, 0.5 * z, 1.0);
      model.bodies.back().w_WB = kTurn * Vector3d::UnitY();
      add_hinge("ground_" + std::to_string(i), -1, i * x, cranks[static_cast<std::size_t>(i)],
                Vector3d::Zero());
    }
    const int bar = add_rod("bar", z, x, 2.0);
    model.bodies.back().v_WB = kTurn * x;
    for (int i = 0; i < 3; ++i)
      add_hinge("top_" + std::to_string(i), cranks[static_cast<std::size_t>(i)], z, bar, i * x);
  }

  world::WorldModel model;

 private:
  static constexpr double kTurn = 3.5;  // rad/s

  int add_rod(const std::string& name, const Vector3d& at, const Vector3d& centre, double length) {
    world::Body body;
    body.name = name;
    body.mass_kg = 1.0;
    body.p_BC = centre;
    body.X_WB.p = at;
    const Vector3d along = centre.normalized();
    body.inertia_C = (length * length / 12.0 * (Vector3d::Ones() - along) + 5e-5 * along).asDiagonal();
    model.bodies.push_back(body);
    return static_cast<int>(model.bodies.size()) - 1;
  }
  void add_hinge(const std::string& name, int parent, const Vector3d& there, int child,
                 const Vector3d& here) {
    world::Joint hinge;
    hinge.name = name;
    if (parent >= 0) hinge.parent = {parent};
    hinge.child = {child};
    hinge.X_PJ.p = there;
    hinge.X_CJ.p = here;
    hinge.axis_J = Vector3d::UnitY();
    model.joints.push_back(hinge);
  }
};

// Returns what some ticks take, with all that the engine remembers of the ticks before, and without.
std::uint64_t work_of(const world::WorldModel& model, bool remembers) {
  Lab lab(model);
  std::uint64_t work = 0;
  for (int i = 0; i < 200; ++i) {
    if (!remembers) lab.state.engines[0].clear();
    work += lab.step().work;
  }
  return work;
}

TEST(Loops, AreForeseen) {
  for (const world::WorldModel& model :
       {physics::four_bars(setting(), 1e-3, 2), physics::bricard(setting(), 1e-3)})
    EXPECT_LT(1.1 * static_cast<double>(work_of(model, true)), static_cast<double>(work_of(model, false)));
}

// The rows that follow from the others change in the swing. An impulse foreseen along one that is left out
// would grow without a gap that shows it, to 5 MN in these 12 s.
TEST(Loops, OneTooManyKeepsItsImpulsesSmall) {
  for (const char* row : {"impulse", "impulse-order4"}) {
    Lab lab(Cranks(setting(row)).model);
    EXPECT_LT(most_apart(lab, 12'000), 2e-10) << row;
    EXPECT_EQ(lab.warned_ticks, 0) << row;
  }
}

// Their axes are in no tree.
TEST(Loops, AxesThatCloseThemArePushedOnce) {
  Lab pushed(physics::four_bars(setting(), 1e-3, 2)), still(physics::four_bars(setting(), 1e-3, 2));
  pushed.drive("close_0").feedforward = 0.5;
  EXPECT_LT(most_apart(pushed, 720), 2e-10);
  still.run_ticks(720);
  EXPECT_GT((pushed.state.bodies[0].p_WC - still.state.bodies[0].p_WC).norm(), 1e-3);
}

TEST(Loops, AStopOutOfReachChangesNothing) {
  world::WorldModel model = physics::four_bars(setting(), 1e-3, 2);
  Lab free(model);
  limit(joint(model, "close_0"), -100.0, 100.0);
  Lab limited(model);
  EXPECT_LT(most_apart(limited, 300), 2e-10);
  free.run_ticks(300);
  for (std::size_t i = 0; i < free.state.bodies.size(); ++i)
    EXPECT_LT((free.state.bodies[i].p_WC - limited.state.bodies[i].p_WC).norm(), 1e-9);
}

// Rows that give nothing must not let the joints fall apart, where the look-ahead cannot follow their
// answers.
TEST(Loops, StayTogetherWithIdleStopsAtRest) {
  world::WorldModel with_axis = resting_bars(0.0);
  with_axis.gravity = -with_axis.gravity;
  limit(joint(with_axis, "close_0"), -100.0, 100.0);
  limit(joint(with_axis, "ground_1"), -5e-4, 1.0);
  Lab held(with_axis);
  EXPECT_LT(most_apart(held, 1000), 1e-12);

  constexpr double kNearTheLine = 1.56;  // rad; the line is at pi/2
  world::WorldModel near = resting_bars(kNearTheLine);
  limit(joint(near, "ground_1"), -5e-4, 3.0);
  joint(near, "ground_1").X_PJ.q = Eigen::Quaterniond(Eigen::AngleAxisd(kNearTheLine, Vector3d::UnitY()));
  Lab weak(near);
  EXPECT_LT(most_apart(weak, 300), 1e-12);
}

TEST(Loops, PassTheLineWithoutAWarning) {
  Lab lab(physics::four_bars(setting(), 1e-3, 2));
  lab.run_ticks(20'000);
  EXPECT_EQ(lab.warned_ticks, 0);
}

}  // namespace
}  // namespace visum::dynamics
