// K11: a robot with four legs. Springs with dampers in software (40 N·m/rad, 1 N·m·s/rad) hold its twelve
// joints, in ticks of 5 ms, as learned gaits command ANYmal.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/model_builder.h"
#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::BodyId;
using world::JointKind;

constexpr double kLegStiffness = 40.0, kDamping = 1.0, kBend = 0.3;  // rad: knees outwards
constexpr double kUpper = 0.25, kLower = 0.25, kFoot = 0.03;         // m

BodyId add_limb(ModelBuilder& b, const std::string& name, double mass_kg, double length, double angle,
                const Vector3d& top) {
  const Vector3d centre =
      top + Eigen::AngleAxisd(angle, Vector3d::UnitY()) * Vector3d(0.0, 0.0, -0.5 * length);
  const BodyId limb =
      b.add_rotor(name, mass_kg, 1.0, at(centre.x(), centre.y(), centre.z(), angle, Vector3d::UnitY()));
  const double across = mass_kg * length * length / 12.0 + 1e-3;
  b.body(limb).inertia_C = Vector3d(across, across, 1e-3).asDiagonal();
  return limb;
}

// The leg hangs at `hip`, its thigh `bend` forwards and its shank as far back; the foot is a ball at its end.
void add_leg(ModelBuilder& b, const std::string& name, BodyId trunk, const Vector3d& hip, double bend) {
  const auto turn = [](double angle) { return Eigen::AngleAxisd(angle, Vector3d::UnitY()); };
  const Vector3d knee = hip + turn(-bend) * Vector3d(0.0, 0.0, -kUpper);
  const Vector3d foot = knee + turn(bend) * Vector3d(0.0, 0.0, -kLower);
  const BodyId root = b.add_rotor(name + "_hip", 1.4, 3e-3, at(hip.x(), hip.y(), hip.z()));
  const BodyId thigh = add_limb(b, name + "_thigh", 1.6, kUpper, -bend, hip);
  const BodyId shank = add_limb(b, name + "_shank", 0.4, kLower, bend, knee);
  const BodyId ball = b.add_sphere(name + "_foot", kFoot, 0.1, at(foot.x(), foot.y(), foot.z()));
  b.add_joint(name + "_spread", JointKind::kHinge, trunk, root, hip, Vector3d::UnitX());
  b.add_joint(name + "_swing", JointKind::kHinge, root, thigh, hip, Vector3d::UnitY());
  b.add_joint(name + "_bend", JointKind::kHinge, thigh, shank, knee, Vector3d::UnitY());
  b.add_joint(name + "_ankle", JointKind::kFixed, shank, ball, foot, Vector3d::UnitZ());
}

ModelBuilder robot(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  b.model.tick_ns = 5'000'000;
  const double height = (kUpper + kLower) * std::cos(kBend) + kFoot - kTouch;
  const BodyId trunk = b.add_box("trunk", {0.5, 0.3, 0.15}, 6.0, at(0, 0, height));
  for (const auto& [name, x, y] : {std::tuple("front_left", 0.3, 0.2), std::tuple("front_right", 0.3, -0.2),
                                   std::tuple("hind_left", -0.3, 0.2), std::tuple("hind_right", -0.3, -0.2)})
    add_leg(b, name, trunk, {x, y, height}, x > 0.0 ? kBend : -kBend);
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
