// K11: a robot with four legs. Springs with dampers in software (40 N·m/rad, 1 N·m·s/rad) hold its twelve
// joints, in ticks of 5 ms, as learned gaits command ANYmal.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/model_builder.h"
#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/legged_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::BodyId;
using world::JointKind;

constexpr double kLegStiffness = 40.0, kDamping = 1.0;
constexpr std::int64_t kTickNs = 5'000'000;

ModelBuilder robot(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  b.model.tick_ns = kTickNs;
  add_quadruped(b, "", 0.0, 0.0);
  return b;
}

void hold_pose(Lab& lab) {
  for (std::size_t i = 0; i < lab.model.joints.size(); ++i) {
    if (lab.model.joints[i].kind != JointKind::kHinge) continue;
    const double wanted = -kLegStiffness / kDamping * lab.state.joints[i].position;
    lab.drives[i] = {wanted, 1.0 / kDamping, 80.0, 0.0};
  }
}

void run_held(Lab& lab, double seconds, const std::function<void()>& look) {
  hold_pose(lab);
  watch(lab, seconds, [&] {
    look();
    hold_pose(lab);
  });
}

double fastest(const Lab& lab) {
  double speed = 0.0;
  for (const auto& body : lab.state.bodies) speed = std::max(speed, body.v_WC.norm());
  return speed;
}

// It sinks into its springs and stands; the ground carries its weight.
std::vector<double> stand_on_four_legs(const world::EngineSetting& engine) {
  auto b = robot(engine);
  b.add_ground();
  Lab lab(b.model);
  run_held(lab, 8.0, [] {});
  double carried = 0.0, weight = 0.0;
  for (const char* foot : {"front_left_foot", "front_right_foot", "hind_left_foot", "hind_right_foot"})
    carried += lab.normal_force_between(foot, "ground");
  for (const auto& body : lab.model.bodies)
    if (!body.fixed) weight += 9.81 * body.mass_kg;
  return {fastest(lab), std::abs(carried / weight - 1.0)};
}

// In space, hit by a ball of 10 kg at 5 m/s: forces among its own joints move it as a whole by nothing.
std::vector<double> be_hit_in_space(const world::EngineSetting& engine) {
  auto b = robot(engine);
  b.model.gravity.setZero();
  const Vector3d trunk = b.body(b.model.find_body("trunk")).X_WB.p;
  b.body(b.add_sphere("ball", 0.1, 10.0, at(0.05, -1.0, trunk.z() + 0.02))).v_WB = {0.0, 5.0, 0.0};
  Lab lab(b.model);
  MomentumDrift drift(lab.model, lab.state);
  run_held(lab, 2.0, [&] { drift.look(lab.model, lab.state); });
  const bool hit = lab.body("trunk").v_WC.norm() > 0.1;
  return {drift.linear, drift.angular, hit ? 0.0 : 1.0};
}

// Its joints are loose. A force on the trunk throws it up for 1 s, then it falls for 2 s. It gains exactly
// the force's work, and afterwards nothing. It does not touch itself.
std::vector<double> throw_and_drop(const world::EngineSetting& engine) {
  auto b = robot(engine);
  const auto bodies = static_cast<std::int32_t>(b.model.bodies.size());
  b.model.no_collision.clear();
  for (std::int32_t i = 0; i < bodies; ++i)
    for (std::int32_t k = i + 1; k < bodies; ++k) b.model.no_collision.emplace_back(BodyId{i}, BodyId{k});
  Lab lab(b.model);
  const Vector3d force(20.0, 10.0, 300.0);  // N; it weighs 20 kg
  const Vector3d from = lab.body("trunk").p_WC;
  const double before = energy_of(lab.model, lab.state);
  lab.wrenches = {{lab.model.find_body("trunk"), force, Vector3d::Zero()}};
  lab.run(1.0);
  lab.wrenches.clear();
  const double work = force.dot(lab.body("trunk").p_WC - from);
  const double thrown = energy_of(lab.model, lab.state);
  double drift = 0.0;
  watch(lab, 2.0, [&] { drift = std::max(drift, std::abs(energy_of(lab.model, lab.state) - thrown)); });
  return {std::abs(thrown - before - work) / work, drift / work};
}

}  // namespace

std::vector<Case> legged_cases() {
  return {
      {"K11e",
       "ThrownRobotKeepsItsEnergy",
       "SimBenchmark's ANYmal, a robot of the same kind; closed form: E grows by F x, then is constant",
       {{"work", 1e-5}, {"energy", 1e-5}},
       throw_and_drop},
      {"K11",
       "FourLeggedRobotStands",
       "SimBenchmark's ANYmal, a robot of the same kind; closed form: no motion, m g carried",
       {{"speed_m_per_s", 1e-4}, {"weight", 1e-4}},
       stand_on_four_legs},
      {"K11m",
       "HitRobotKeepsMomentum",
       "SimBenchmark's ANYmal, a robot of the same kind; closed form: P and L constant",
       {{"momentum", 1e-9}, {"angular_momentum", 1e-9}, {"missed", 0.0}},
       be_hit_in_space},
  };
}

}  // namespace visum::physics
