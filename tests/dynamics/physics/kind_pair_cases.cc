// J7o: the order of springs. J8, J9: kinds of joints whose motion has no closed form, and the quantities that
// they must keep.
#include <algorithm>
#include <cmath>

#include "server/world/joint_kinds.h"
#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/kind_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::BodyId;
using world::JointKind;

const Vector3d kPairPlace{0.25, 0.1, 0.15}, kPairAxis = Vector3d(1.0, -2.0, 2.0) / 3.0;

// The motion that is free for B against A at the joint: an angular velocity, and a velocity there.
struct Freedom {
  Vector3d w = Vector3d::Zero(), v = Vector3d::Zero();
};

Freedom freedom_of(const world::Joint& joint, const Eigen::Quaterniond& q_WJ) {
  const Vector3d a = q_WJ * joint.axis_J, across = q_WJ * Vector3d::UnitY(), any(2.0, -1.0, 1.5);
  switch (joint.kind) {
    case JointKind::kUniversal:
      return {1.5 * a - 2.0 * (q_WJ * joint.axis2_J), Vector3d::Zero()};
    case JointKind::kCylindrical:
      return {2.0 * a, 0.4 * a};
    case JointKind::kScrew:
      return {2.0 * a, screw_lift(joint, 2.0) * a};
    case JointKind::kPointOnLine:
      return {any, 0.4 * a};
    default:  // on a plane or a curve
      return {any, 0.4 * across};
  }
}

// Two bodies in space that turn together, and against each other as the joint allows.
world::WorldModel pair_in_space(const world::EngineSetting& engine, JointKind kind) {
  ModelBuilder b(engine);
  b.model.gravity.setZero();
  const BodyId first = add_bulk(b, "first", 1.0, {0.02, 0.03, 0.04}, at(0, 0, 0, 0.4, {1, 2, 0}));
  const BodyId second = add_bulk(b, "second", 2.0, {0.05, 0.06, 0.03}, at(0.4, 0.3, 0.2, 1.1, {0, 1, -1}));
  world::Joint& joint = b.add_joint("joint", kind, first, second, kPairPlace, kPairAxis);
  joint.pitch_m = 0.5;
  joint.curve_J = circle(0.3, Vector3d::UnitX(), Vector3d::UnitY());
  const Eigen::Quaterniond q_WJ = b.body(first).X_WB.q * joint.X_PJ.q;
  const Vector3d v(0.1, -0.2, 0.3), w(1.0, -0.5, 0.8);
  const Freedom freedom = freedom_of(joint, q_WJ);
  b.body(first).w_WB = w;
  b.body(first).v_WB = v;
  world::Body& body = b.body(second);
  body.w_WB = w + freedom.w;
  body.v_WB = v + w.cross(body.X_WB.p) + freedom.v + freedom.w.cross(body.X_WB.p - kPairPlace);
  return b.model;
}

std::vector<double> keep_all(const world::EngineSetting& engine) {
  std::vector<double> figures;
  double momentum = 0.0, gap = 0.0;
  for (const JointKind kind : {JointKind::kUniversal, JointKind::kCylindrical, JointKind::kScrew,
                               JointKind::kPointOnPlane, JointKind::kPointOnLine, JointKind::kPointOnCurve}) {
    Lab lab(pair_in_space(engine, kind));
    const double energy = energy_of(lab.model, lab.state);
    MomentumDrift drift(lab.model, lab.state);
    double worst = 0.0;
    watch(lab, 1.0, [&] {
      worst = std::max(worst, std::abs(energy_of(lab.model, lab.state) / energy - 1.0));
      drift.look(lab.model, lab.state);
      gap = std::max(gap, max_gap(lab.model, lab.state));
    });
    figures.push_back(worst);
    momentum = std::max({momentum, drift.linear, drift.angular});
  }
  figures.push_back(momentum);
  figures.push_back(gap);
  return figures;
}

// Four bodies on a universal, a cylindrical, a screw and a ball joint, with a spring along the second and one
// about the third.
ModelBuilder mixed_chain(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  const Vector3d inertia(0.004, 0.006, 0.005), x = Vector3d::UnitX(), y = Vector3d::UnitY();
  std::vector<BodyId> links;
  for (int i = 0; i < 4; ++i)
    links.push_back(add_bulk(b, "link_" + std::to_string(i), 1.0, inertia,
                             at(0.1 + 0.2 * i, 0.02 * i, 0.03, 0.3 * i, {1, 1, 1})));
  auto& cross = b.add_joint("universal", JointKind::kUniversal, {}, links[0], Vector3d::Zero(), y);
  cross.axis2_J = cross.X_PJ.q.conjugate() * Vector3d::UnitZ();
  b.add_joint("cylindrical", JointKind::kCylindrical, links[0], links[1], 0.2 * x, x);
  b.add_joint("screw", JointKind::kScrew, links[1], links[2], 0.4 * x, y).pitch_m = 0.1;
  b.add_joint("ball", JointKind::kBall, links[2], links[3], 0.6 * x, y);
  auto& spring = b.add_joint("spring", JointKind::kSpring, links[0], links[1], 0.1 * x, x);
  spring.X_CJ.p = Vector3d::Zero();
  spring.stiffness = 300.0;
  spring.rest = 0.2;
  auto& torsion = b.add_joint("torsion_spring", JointKind::kTorsionSpring, links[1], links[2], 0.4 * x, y);
  torsion.stiffness = 2.0;
  return b;
}

// kind: the joint that leads the last link's end; kBall: none does.
world::WorldModel mixed(const world::EngineSetting& engine, JointKind kind) {
  ModelBuilder b = mixed_chain(engine);
  if (kind == JointKind::kBall) return b.model;
  auto& guide = b.add_joint(
      "guide", kind, {}, b.model.find_body("link_3"), {0.8, 0.0, 0.0},
      kind == JointKind::kPointOnPlane ? Vector3d(1, 1, 0).normalized() : Vector3d(-1, 0.5, -2).normalized());
  guide.curve_J = circle(0.5, Vector3d::UnitX(), Vector3d::UnitZ());
  return b.model;
}

std::vector<double> keep_energy(const world::EngineSetting& engine) {
  constexpr double kScaleJ = 4.0 * kG * 0.8;  // the whole mechanism, as far down as it reaches
  std::vector<double> figures;
  double gap = 0.0, most_j = 0.0;
  for (const JointKind kind :
       {JointKind::kBall, JointKind::kPointOnPlane, JointKind::kPointOnLine, JointKind::kPointOnCurve}) {
    Lab lab(mixed(engine, kind));
    const double energy = energy_of(lab.model, lab.state);
    double worst = 0.0;
    most_j = 0.0;
    watch(lab, 1.0, [&] {
      worst = std::max(worst, std::abs(energy_of(lab.model, lab.state) - energy) / kScaleJ);
      gap = std::max(gap, max_gap(lab.model, lab.state));
      most_j = std::max(most_j, lab.kinetic_energy());
    });
    figures.push_back(most_j > 1.0 ? worst : 1.0);  // a mechanism that hangs still keeps its energy, too
  }
  figures.push_back(gap);
  return figures;
}

// A mass that circles at the end of a spring: m p'' = -k (|p| - l0) p/|p|.
constexpr double kOrbitStiffness = 100.0, kOrbitRest = 0.5;
const Vector3d kOrbitFrom{0.8, 0.0, 0.0}, kOrbitSpeed{0.0, 2.0, 1.0};

// After 1 s, by RK4 in steps of 0.1 ms.
Vector3d exact_orbit() {
  constexpr double kStep = 1e-4;
  const auto f = [](const Vector3d& p) {
    return Vector3d(-kOrbitStiffness * (p.norm() - kOrbitRest) * p.normalized());
  };
  Vector3d p = kOrbitFrom, v = kOrbitSpeed;
  for (int i = 0; i < 10'000; ++i) {
    const Vector3d a1 = f(p), v2 = v + 0.5 * kStep * a1, a2 = f(p + 0.5 * kStep * v);
    const Vector3d v3 = v + 0.5 * kStep * a2, a3 = f(p + 0.5 * kStep * v2);
    const Vector3d v4 = v + kStep * a3, a4 = f(p + kStep * v3);
    p += kStep / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += kStep / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return p;
}

double orbit_error(const world::EngineSetting& engine, double tick_s) {
  ModelBuilder b(engine);
  b.model.gravity.setZero();
  b.model.tick_ns = std::llround(1e9 * tick_s);
  const BodyId id = add_bulk(b, "mass", 1.0, {0.01, 0.01, 0.01}, at(kOrbitFrom.x(), 0.0, 0.0));
  b.body(id).v_WB = kOrbitSpeed;
  auto& spring = b.add_joint("spring", JointKind::kSpring, {}, id, Vector3d::Zero(), Vector3d::UnitZ());
  spring.X_CJ.p = Vector3d::Zero();
  spring.stiffness = kOrbitStiffness;
  spring.rest = kOrbitRest;
  Lab lab(b.model);
  lab.run(1.0);
  return (lab.body("mass").p_WC - exact_orbit()).norm();
}

std::vector<double> go_round(const world::EngineSetting& engine) {
  const double coarse = orbit_error(engine, 2e-3), fine = orbit_error(engine, 1e-3);
  return {fine, std::abs(std::log2(coarse / fine) / engine.order - 1.0)};
}

}  // namespace

std::vector<Case> kind_pair_cases() {
  return {
      {"J7o",
       "SpringKeepsTheOrder",
       "m p'' = -k (|p| - l) p/|p| by RK4 in steps of 0.1 ms; slope of log(error) from 2 ms to 1 ms",
       {{"place_m", 1e-4}, {"order", 0.05}},
       go_round},
      {"J8",
       "PairsInSpaceKeepEnergyAndMomentum",
       "closed form: E, P and L constant",
       {{"energy_universal", 1e-4},
        {"energy_cylindrical", 1e-4},
        {"energy_screw", 1e-4},
        {"energy_plane", 1e-4},
        {"energy_line", 1e-4},
        {"energy_curve", 1e-4},
        {"momentum", 1e-12},
        {"gap_m", 1e-5}},
       keep_all},
      {"J9",
       "MechanismsOfManyKindsKeepTheirEnergy",
       "closed form: E constant, gap 0: a tree, and led by a plane, a line, a curve",
       {{"energy_tree", 1e-4},
        {"energy_plane", 1e-4},
        {"energy_line", 1e-4},
        {"energy_curve", 1e-4},
        {"gap_m", 1e-5}},
       keep_energy},
  };
}

}  // namespace visum::physics
