// J: kinds of joints, each one alone, where the motion that it leaves free has a closed form.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/kind_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::JointKind;

const Vector3d kAskew = Vector3d(1.0, 2.0, 2.0) / 3.0;
const Vector3d kAside = Vector3d(2.0, -2.0, 1.0) / 3.0;  // across it

// Two shafts at 30° in the plane x, y, each on a hinge, joined where they meet. Their rotors are off their
// axes by kOff. The cross's arm on the first shaft starts in that plane.
constexpr double kShaftBend = 30.0 * kDegree, kOff = 0.1, kFirst = 0.02, kSecond = 0.05, kTurning = 5.0;

double cardan_ratio(double angle) {
  const double s = std::sin(kShaftBend) * std::cos(angle);
  return std::cos(kShaftBend) / (1.0 - s * s);
}

world::WorldModel cardan_shafts(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  b.model.gravity.setZero();
  const Vector3d e1 = Vector3d::UnitX(), e2(std::cos(kShaftBend), std::sin(kShaftBend), 0.0),
                 up = Vector3d::UnitZ();
  const auto shaft = [&](const char* name, const Vector3d& axis, double place, double inertia, double speed) {
    const Vector3d p = place * axis + kOff * up;
    const auto id = b.add_rotor(name, 1.0, inertia, {p, Eigen::Quaterniond::Identity()});
    b.body(id).w_WB = speed * axis;
    b.body(id).v_WB = speed * axis.cross(kOff * up);
    return id;
  };
  const auto first = shaft("first", e1, -0.3, kFirst, kTurning);
  const auto second = shaft("second", e2, 0.3, kSecond, kTurning * cardan_ratio(0.0));
  b.add_joint("first", JointKind::kHinge, {}, first, -0.3 * e1, e1);
  world::Joint& cross =
      b.add_joint("cross", JointKind::kUniversal, first, second, Vector3d::Zero(), Vector3d::UnitY());
  cross.axis2_J = cross.X_PJ.q.conjugate() * up;
  b.add_joint("second", JointKind::kHinge, {}, second, 0.3 * e2, e2);
  return b.model;
}

std::vector<double> turn_shafts(const world::EngineSetting& engine) {
  constexpr double kJ1 = kFirst + kOff * kOff, kJ2 = kSecond + kOff * kOff;
  Lab lab(cardan_shafts(engine));
  const auto inertia = [&](double angle) { return kJ1 + kJ2 * cardan_ratio(angle) * cardan_ratio(angle); };
  double ratio = 0.0, speed = 0.0, gap = 0.0;
  watch(lab, 2.0, [&] {
    const auto &first = lab.joint("first"), &second = lab.joint("second");
    ratio =
        std::max(ratio, std::abs(second.velocity / (first.velocity * cardan_ratio(first.position)) - 1.0));
    const double exact = kTurning * std::sqrt(inertia(0.0) / inertia(first.position));
    speed = std::max(speed, std::abs(first.velocity / exact - 1.0));
    gap = std::max(gap, max_gap(lab.model, lab.state));
  });
  return {ratio, speed, gap};
}

// A box whose centre of mass is 0.3 m off an axis; gravity acts along the axis.
struct OnAxis {
  static constexpr double kAway = 0.3;

  OnAxis(const world::EngineSetting& engine, JointKind kind) : builder(engine) {
    builder.model.gravity = -kG * kAskew;
    id = add_bulk(
        builder, "box", 2.0, {0.03, 0.05, 0.02},
        {kAway * kAside, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1, -1, 2).normalized()))});
    builder.add_joint("joint", kind, {}, id, Vector3d::Zero(), kAskew);
  }
  double inertia() {
    const world::Body& body = builder.body(id);
    const Vector3d axis_B = body.X_WB.q.conjugate() * kAskew;
    return axis_B.dot(body.inertia_C * axis_B) + body.mass_kg * kAway * kAway;
  }

  ModelBuilder builder;
  world::BodyId id;
};

std::vector<double> slide_and_turn(const world::EngineSetting& engine) {
  constexpr double kSlides = 3.0, kTurns = 2.0, kSeconds = 1.0;
  OnAxis box(engine, JointKind::kCylindrical);
  world::Body& body = box.builder.body(box.id);
  body.w_WB = kTurns * kAskew;
  body.v_WB = kSlides * kAskew + body.w_WB.cross(body.X_WB.p);
  const world::Pose start = body.X_WB;
  Lab lab(box.builder.model);
  double gap = 0.0;
  watch(lab, kSeconds, [&] { gap = std::max(gap, max_gap(lab.model, lab.state)); });
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(kTurns * kSeconds, kAskew));
  const Vector3d p = turned * start.p + (kSlides * kSeconds - 0.5 * kG * kSeconds * kSeconds) * kAskew;
  const auto& motion = lab.body("box");
  return {(motion.p_WC - p).norm(), motion.q_WB.angularDistance(turned * start.q), gap};
}

std::vector<double> screw_down(const world::EngineSetting& engine) {
  constexpr double kPitch = 1.0, kLift = kPitch / (2.0 * std::numbers::pi), kSeconds = 1.0;
  OnAxis box(engine, JointKind::kScrew);
  box.builder.model.joints.back().pitch_m = kPitch;
  const double mass = box.builder.body(box.id).mass_kg;
  const double angle =
      -0.5 * mass * kG * kLift / (box.inertia() + mass * kLift * kLift) * kSeconds * kSeconds;
  const Vector3d start = box.builder.body(box.id).X_WB.p;
  Lab lab(box.builder.model);
  double gap = 0.0;
  watch(lab, kSeconds, [&] { gap = std::max(gap, max_gap(lab.model, lab.state)); });
  const Vector3d p = Eigen::AngleAxisd(angle, kAskew) * start + kLift * angle * kAskew;
  return {std::abs(lab.joint("joint").position - angle), (lab.body("box").p_WC - p).norm(), gap};
}

// A rod with its end in a plane without friction: the plane's force is along its normal only.
std::vector<double> slip_on_plane(const world::EngineSetting& engine) {
  constexpr double kSeconds = 1.0;
  const Vector3d normal = Vector3d(0.3, -0.2, 1.0).normalized();
  ModelBuilder b(engine);
  const Eigen::Quaterniond lean(Eigen::AngleAxisd(0.9, Vector3d(1.0, 2.0, 0.0).normalized()));
  const auto id =
      add_bulk(b, "rod", 1.0, {1.0 / 12.0, 1.0 / 12.0, 1e-3}, {lean * Vector3d(0.0, 0.0, 0.5), lean});
  world::Body& body = b.body(id);
  const Vector3d along = Vector3d(1.0, -1.0, 0.0).cross(normal);
  body.w_WB = {1.0, -2.0, 3.0};
  body.v_WB = 0.5 * along + body.w_WB.cross(body.X_WB.p);  // its end, at the origin, moves in the plane
  b.add_joint("plane", JointKind::kPointOnPlane, {}, id, Vector3d::Zero(), normal);
  Lab lab(b.model);
  const auto across = [&](const Vector3d& u) { return Vector3d(u - normal * normal.dot(u)); };
  const auto start = lab.state.bodies[0];
  const auto spin = [&] { return normal.dot(spin_of(lab.model.bodies[0], lab.state.bodies[0])); };
  const double energy = energy_of(lab.model, lab.state), first_spin = spin();
  double way = 0.0, turn = 0.0, drift = 0.0, gap = 0.0, t = 0.0;
  watch(lab, kSeconds, [&] {
    t += lab.tick_s();
    const Vector3d exact = start.p_WC + t * start.v_WC + 0.5 * t * t * lab.model.gravity;
    way = std::max(way, across(lab.state.bodies[0].p_WC - exact).norm());
    turn = std::max(turn, std::abs(spin() / first_spin - 1.0));
    drift = std::max(drift, std::abs(energy_of(lab.model, lab.state) - energy) / kG);
    gap = std::max(gap, max_gap(lab.model, lab.state));
  });
  return {way, turn, drift, gap};
}

// P1's angles after 1 s and 2 s, of a pendulum that swings as a point on a rod of 1 m does, from 90°.
constexpr double kAt1s = -1.4050273115248, kAt2s = 0.91664758966324;

// A rod swings across a line that falls by 30° while its end slides down the line. Across the line gravity is
// weaker by cos 30°: it swings as if on level ground, with an equivalent length that is shorter by as much.
std::vector<double> swing_below_line(const world::EngineSetting& engine) {
  const double fall = 30.0 * kDegree, reach = 0.5;
  const Vector3d line(std::cos(fall), 0.0, -std::sin(fall)), down(-std::sin(fall), 0.0, -std::cos(fall));
  ModelBuilder b(engine);
  const double inertia = reach * (std::cos(fall) - reach);
  const auto id = add_bulk(b, "rod", 1.0, {inertia, 1e-3, inertia}, at(0.0, reach, 0.0));
  b.add_joint("line", JointKind::kPointOnLine, {}, id, Vector3d::Zero(), line);
  Lab lab(b.model);
  std::vector<double> figures;
  double gap = 0.0, way = 0.0;
  for (const double angle : {kAt1s, kAt2s}) {
    watch(lab, 1.0, [&] { gap = std::max(gap, max_gap(lab.model, lab.state)); });
    const Vector3d rod = lab.body("rod").q_WB * Vector3d::UnitY();
    figures.push_back(std::abs(std::atan2(rod.y(), rod.dot(down)) - angle));
    const double t = lab.tick_s() * static_cast<double>(lab.state.tick);
    way = std::max(way, std::abs(lab.joint("line").position - 0.5 * kG * std::sin(fall) * t * t));
  }
  figures.push_back(way);
  figures.push_back(gap);
  return figures;
}

// A bead on an upright circle of 1 m; it spins, which does not matter to the wire.
std::vector<double> slide_on_circle(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  const auto id = add_bulk(b, "bead", 1.0, {0.01, 0.02, 0.015}, at(1.0, 0.0, 0.0));
  b.body(id).w_WB = {1.0, 2.0, 3.0};
  b.add_joint("wire", JointKind::kPointOnCurve, {}, id, {1.0, 0.0, 0.0}, Vector3d::UnitZ()).curve_J =
      circle(1.0, Vector3d::UnitX(), Vector3d::UnitZ());
  Lab lab(b.model);
  std::vector<double> figures;
  double off = 0.0;
  for (const double angle : {kAt1s, kAt2s}) {
    watch(lab, 1.0, [&] { off = std::max(off, std::abs(lab.body("bead").p_WC.norm() - 1.0)); });
    const Vector3d p = lab.body("bead").p_WC;
    figures.push_back(std::abs(std::atan2(p.x(), -p.z()) - angle));
  }
  figures.push_back(off);
  return figures;
}

// Two wheels in space on one axle with a torsion spring between them, of 1 Hz against each other.
constexpr double kRest = 0.3, kSpringDamping = 0.05;

world::WorldModel sprung_wheels(const world::EngineSetting& engine, double damping) {
  ModelBuilder b(engine);
  b.model.gravity.setZero();
  const auto first = b.add_rotor("first", 1.0, kFirst, at(0, 0, 0));
  const auto second = b.add_rotor("second", 2.0, kSecond, {0.2 * kAskew, Eigen::Quaterniond::Identity()});
  for (const auto id : {first, second}) {
    b.body(id).v_WB = {0.3, -0.1, 0.2};
    b.body(id).w_WB = kAskew;
  }
  b.add_joint("axle", JointKind::kHinge, first, second, Vector3d::Zero(), kAskew);
  auto& spring = b.add_joint("spring", JointKind::kTorsionSpring, first, second, Vector3d::Zero(), kAskew);
  const double rate = 2.0 * std::numbers::pi;
  spring.stiffness = rate * rate * kFirst * kSecond / (kFirst + kSecond);
  spring.rest = kRest;
  spring.damping = damping;
  return b.model;
}

// Solution of x'' + 2 δ x' + ω² x = 0 from x = -kRest, at rest; measured from there.
double sprung_angle(double damping, double t) {
  const double delta = 0.5 * damping * (kFirst + kSecond) / (kFirst * kSecond);
  const double rate = std::sqrt(4.0 * std::numbers::pi * std::numbers::pi - delta * delta);
  return kRest * (1.0 - std::exp(-delta * t) * (std::cos(rate * t) + delta / rate * std::sin(rate * t)));
}

std::vector<double> swing_by_spring(const world::EngineSetting& engine) {
  std::vector<double> figures;
  double momentum = 0.0;
  for (const double damping : {0.0, kSpringDamping}) {
    Lab lab(sprung_wheels(engine, damping));
    MomentumDrift drift(lab.model, lab.state);
    double worst = 0.0;
    watch(lab, 2.0, [&] {
      const double t = lab.tick_s() * static_cast<double>(lab.state.tick);
      worst = std::max(worst, std::abs(lab.joint("spring").position - sprung_angle(damping, t)));
      drift.look(lab.model, lab.state);
    });
    figures.push_back(worst);
    momentum = std::max({momentum, drift.linear, drift.angular});
  }
  figures.push_back(momentum);
  return figures;
}

}  // namespace

std::vector<Case> kind_cases() {
  return {
      {"J1",
       "UniversalJointTurnsAShaftUnevenly",
       "closed form: speeds as cos b / (1 - sin² b cos² q), E constant",
       {{"ratio", 1e-4}, {"speed", 1e-4}, {"gap_m", 1e-5}},
       turn_shafts},
      {"J2",
       "CylindricalJointSlidesAndTurns",
       "closed form: s = v t - g t²/2 along the axis, w t about it",
       {{"place_m", 1e-5}, {"orientation_rad", 1e-5}, {"gap_m", 1e-5}},
       slide_and_turn},
      {"J3",
       "ScrewFallsAsItTurns",
       "closed form: q'' = -m g k / (J + m k²), k = pitch / 2π",
       {{"angle_rad", 1e-4}, {"place_m", 1e-4}, {"gap_m", 1e-5}},
       screw_down},
      {"J4",
       "RodSlipsOnAPlane",
       "closed form: parabola along the plane; spin about its normal and E constant",
       {{"way_m", 1e-9}, {"spin", 1e-9}, {"energy", 1e-4}, {"gap_m", 1e-5}},
       slip_on_plane},
      {"J5",
       "RodSwingsBelowALine",
       "closed form: g sin a t²/2 along the line; across it P1's angles, g and equivalent length by cos a",
       {{"angle_1s_rad", 1e-5}, {"angle_2s_rad", 1e-5}, {"way_m", 1e-9}, {"gap_m", 1e-5}},
       swing_below_line},
      {"J6",
       "BeadOnACircleIsAPendulum",
       "closed form: P1's angles",
       {{"angle_1s_rad", 2e-5}, {"angle_2s_rad", 2e-5}, {"off_m", 1e-5}},
       slide_on_circle},
      {"J7",
       "TorsionSpringSwingsTwoWheels",
       "closed form: x'' + d x'/J + k x/J = 0, J = J1 J2 / (J1 + J2); P and L constant",
       {{"angle_rad", 1e-4}, {"damped_angle_rad", 1e-4}, {"momentum", 1e-12}},
       swing_by_spring},
  };
}

}  // namespace visum::physics
