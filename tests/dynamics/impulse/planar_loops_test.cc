// Loops in a plane have rows in that plane alone: they move as in closed form, in any direction and on a free
// body, and what is not quite a plane is none.
#include <gtest/gtest.h>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::dynamics {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::Lab;
using testing::ModelBuilder;
using world::BodyId;
using world::JointKind;

const world::EngineSetting kImpulse = physics::engine_row("impulse").setting;

constexpr double kCrank = 0.3, kRod = 0.8;  // m

// A crank turns about the origin, a rod leads from its tip to a piston, which slides along x. All is turned
// by `turn` about the origin. The joint between rod and piston is of the kind `pin`.
struct CrankAndPiston {
  CrankAndPiston(const Quaterniond& turn, bool slider_closes, JointKind pin = JointKind::kHinge)
      : builder(kImpulse) {
    builder.model.tick_ns = 1'000'000;
    builder.model.gravity.setZero();
    const double reach = std::sqrt(kRod * kRod - kCrank * kCrank);
    const Vector3d tip(0.0, 0.0, kCrank), end(reach, 0.0, 0.0);
    // Their frames are turned against each other.
    const auto at = [&](const Vector3d& p, double angle = 0.0) {
      return world::Pose{turn * p, turn * Eigen::AngleAxisd(angle, Vector3d(0.6, 0.0, 0.8))};
    };
    const BodyId crank = builder.add_box("crank", {0.05, 0.05, kCrank}, 1.0, at(0.5 * tip, 0.7));
    const BodyId rod = builder.add_rotor("rod", 0.5, 0.03, at(0.5 * (tip + end), -1.1));
    const BodyId eye = builder.add_rotor("eye", 0.1, 1e-4, at(end));  // the rod's end, fixed to it
    const BodyId piston = builder.add_box("piston", {0.1, 0.1, 0.1}, 2.0, at(end));
    const auto join = [&](const char* name, JointKind kind, BodyId a, BodyId b, const Vector3d& p) {
      const Vector3d axis = kind == JointKind::kSlider ? Vector3d::UnitX() : Vector3d::UnitY();
      builder.add_joint(name, kind, a, b, turn * p, turn * axis);
    };
    join("ground", JointKind::kHinge, {}, crank, Vector3d::Zero());
    join("tip", JointKind::kHinge, crank, rod, tip);
    join("welded", JointKind::kFixed, rod, eye, end);
    if (!slider_closes) join("slide", JointKind::kSlider, {}, piston, end);
    join("pin", pin, eye, piston, end);
    if (slider_closes) join("slide", JointKind::kSlider, {}, piston, end);
    // The crank turns at 4 rad/s, and with the crank upright the rod only shifts.
    const Vector3d shift = 4.0 * kCrank * Vector3d::UnitX();
    builder.body(crank).w_WB = turn * (4.0 * Vector3d::UnitY());
    builder.body(crank).v_WB = turn * (0.5 * shift);
    for (const BodyId body : {rod, eye, piston}) builder.body(body).v_WB = turn * shift;
  }

  ModelBuilder builder;
};

const Quaterniond kTurned(Eigen::AngleAxisd(1.0, Vector3d(1.0, -2.0, 0.5).normalized()));

// How far the piston is from its place in closed form, m and rad, at the most in some seconds.
double piston_off(Lab& lab, const Quaterniond& turn) {
  double most = 0.0;
  for (int i = 0; i < 3000; ++i) {
    EXPECT_TRUE(lab.step().ok) << i;
    const auto& crank = lab.body("crank");
    const Vector3d tip = turn.conjugate() * (2.0 * crank.p_WC);
    const Vector3d piston = turn.conjugate() * lab.body("piston").p_WC;
    const Vector3d expected(tip.x() + std::sqrt(kRod * kRod - tip.z() * tip.z()), 0.0, 0.0);
    most = std::max({most, (piston - expected).norm(), lab.body("piston").q_WB.angularDistance(turn)});
  }
  return most;
}

TEST(PlanarLoops, APistonIsWhereItsCrankPutsIt) {
  for (const bool slider_closes : {false, true})
    for (const Quaterniond& turn : {Quaterniond::Identity(), kTurned}) {
      Lab lab(CrankAndPiston(turn, slider_closes).builder.model);
      const double energy = lab.kinetic_energy();
      EXPECT_LT(piston_off(lab, turn), 1e-9) << slider_closes;
      EXPECT_NEAR(lab.kinetic_energy(), energy, 1e-5 * energy);
      EXPECT_EQ(lab.warned_ticks, 0);
    }
}

// A loop that a ball closes has rows in space. Here it holds the same as one that a pin closes, since the
// other joints do the rest.
TEST(PlanarLoops, MoveAsLoopsInSpaceAndTakeLessWork) {
  Lab plane(CrankAndPiston(kTurned, false).builder.model);
  Lab space(CrankAndPiston(kTurned, false, JointKind::kBall).builder.model);
  std::uint64_t in_plane = 0, in_space = 0;
  for (int i = 0; i < 1000; ++i) {
    in_plane += plane.step().work;
    in_space += space.step().work;
  }
  EXPECT_LT((plane.body("piston").p_WC - space.body("piston").p_WC).norm(), 1e-9);
  EXPECT_LT(1.1 * static_cast<double>(in_plane), static_cast<double>(in_space));
}

TEST(PlanarLoops, OnAFreeBodyKeepMomentum) {
  world::WorldModel model = physics::four_bars(kImpulse, 1e-3, 2);
  model.gravity.setZero();
  world::Body base;
  base.name = "base";
  base.mass_kg = 5.0;
  base.inertia_C = Vector3d(0.3, 0.5, 0.4).asDiagonal();
  base.w_WB = {0.3, 0.0, 0.2};
  for (world::Body& body : model.bodies) {  // the rods turn with the base, beside their own motion
    body.v_WB += base.w_WB.cross(body.X_WB.p);
    body.w_WB += base.w_WB;
  }
  model.bodies.push_back(base);
  for (world::Joint& joint : model.joints)
    if (!joint.parent.valid()) joint.parent = {static_cast<std::int32_t>(model.bodies.size()) - 1};
  Lab lab(model);
  physics::MomentumDrift drift(lab.model, lab.state);
  double gap = 0.0;
  for (int i = 0; i < 1000; ++i) {  // not yet at the line
    ASSERT_TRUE(lab.step().ok) << i;
    drift.look(lab.model, lab.state);
    gap = std::max(gap, physics::max_gap(lab.model, lab.state));
  }
  EXPECT_LT(drift.linear, 1e-12);
  EXPECT_LT(drift.angular, 1e-12);
  EXPECT_LT(gap, 2e-10);
  EXPECT_EQ(lab.warned_ticks, 0);
}

// A slider that leans out of the plane holds the crank as well.
TEST(PlanarLoops, ALeaningSliderIsNoPlane) {
  for (const bool slider_closes : {false, true}) {
    world::WorldModel model = CrankAndPiston(kTurned, slider_closes).builder.model;
    for (world::Body& body : model.bodies) {
      body.v_WB.setZero();
      body.w_WB.setZero();
    }
    model.gravity = kTurned * Vector3d(9.81, 0.0, 0.0);
    for (world::Joint& joint : model.joints)
      if (joint.name == "slide")
        joint.axis_J = (joint.axis_J + 0.01 * (kTurned * Vector3d::UnitY())).normalized();
    Lab lab(model);
    const Vector3d start = lab.body("crank").p_WC;
    lab.run_ticks(200);
    EXPECT_LT((lab.body("crank").p_WC - start).norm(), 1e-9) << slider_closes;
  }
}

// One hinge that leans by a hundredth of a radian holds the whole mechanism, wherever it is.
TEST(PlanarLoops, OneLeaningHingeIsNoPlane) {
  for (const char* name : {"close_0", "carry_0", "ground_1", ""}) {
    world::WorldModel model = physics::four_bars(kImpulse, 1e-3, 1);
    model.gravity = {9.81, 0.0, 0.0};
    for (world::Body& body : model.bodies) {
      body.v_WB.setZero();
      body.w_WB.setZero();
    }
    for (world::Joint& joint : model.joints)
      if (joint.name == name) joint.axis_J = Vector3d(0.01, 1.0, 0.0).normalized();
    Lab lab(model);
    lab.run_ticks(200);
    const double way = (lab.body("coupler_0").p_WC - Vector3d(0.5, 0.0, 1.0)).norm();
    if (*name == '\0')
      EXPECT_GT(way, 0.1);
    else
      EXPECT_LT(way, 1e-9) << name;
  }
}

}  // namespace
}  // namespace visum::dynamics
