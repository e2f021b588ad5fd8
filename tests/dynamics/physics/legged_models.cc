#include "tests/dynamics/physics/legged_models.h"

#include <cmath>

#include "tests/dynamics/physics/contact_models.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::BodyId;
using world::JointKind;

constexpr double kBend = 0.3;                                 // rad: knees outwards
constexpr double kUpper = 0.25, kLower = 0.25, kFoot = 0.03;  // m
constexpr int kInARow = 10;
constexpr double kHeldNm = 80.0;                     // dry friction that holds a leg's joint
constexpr double kLegStiffness = 40.0, kDamp = 1.0;  // N·m/rad, N·m·s/rad

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

// Holds every hinge of the model where it is.
void hold(ModelBuilder& b, Held held) {
  const std::size_t joints = b.model.joints.size();
  for (std::size_t i = 0; i < joints; ++i) {
    world::Joint& joint = b.model.joints[i];
    if (joint.kind != JointKind::kHinge) continue;
    if (held == Held::kByFriction) {
      joint.friction = kHeldNm;
      continue;
    }
    world::Joint spring = joint;
    spring.name += "_spring";
    spring.kind = JointKind::kTorsionSpring;
    spring.stiffness = kLegStiffness;
    spring.damping = kDamp;
    b.model.joints.push_back(spring);
  }
}

// Two upright bars side by side, and a plate below that joins them, with a foot under its middle.
void add_parallelogram(ModelBuilder& b, const std::string& name, BodyId top, const Vector3d& hip) {
  constexpr double kBar = 0.3, kApart = 0.1;
  const Vector3d middle = hip - kBar * Vector3d::UnitZ();
  const BodyId plate =
      b.add_box(name + "_plate", {kApart, 0.04, 0.02}, 0.2, at(middle.x(), middle.y(), middle.z()));
  for (const double side : {0.5, -0.5}) {
    const std::string bar_name = name + (side > 0.0 ? "_front" : "_back");
    const Vector3d across = side * kApart * Vector3d::UnitX();
    const BodyId bar = add_limb(b, bar_name, 0.3, kBar, 0.0, hip + across);
    b.add_joint(bar_name + "_swing", JointKind::kHinge, top, bar, hip + across, Vector3d::UnitY());
    b.add_joint(bar_name + "_ankle", JointKind::kHinge, bar, plate, middle + across, Vector3d::UnitY());
    if (side > 0.0) b.model.joints[b.model.joints.size() - 2].friction = kHeldNm;
  }
  const BodyId ball =
      b.add_sphere(name + "_foot", kFoot, 0.1, at(middle.x(), middle.y(), middle.z() - kFoot));
  b.add_joint(name + "_sole", JointKind::kFixed, plate, ball, middle, Vector3d::UnitZ());
}

// The parts of a ragdoll: lengths and centre of a box, m, and what it hangs on, by index; -1: nothing.
struct Part {
  const char* name;
  Vector3d lengths, centre;
  double mass_kg;
  int parent;
  JointKind kind;
  Vector3d anchor;
};

const std::vector<Part>& ragdoll_parts() {
  static const std::vector<Part> parts{
      {"pelvis", {0.20, 0.30, 0.15}, {0, 0, 0}, 10.0, -1, JointKind::kFixed, {0, 0, 0}},
      {"chest", {0.20, 0.34, 0.40}, {0, 0, 0.30}, 22.0, 0, JointKind::kBall, {0, 0, 0.09}},
      {"head", {0.18, 0.16, 0.22}, {0, 0, 0.65}, 5.0, 1, JointKind::kBall, {0, 0, 0.52}},
      {"left_arm", {0.09, 0.30, 0.09}, {0, 0.34, 0.45}, 2.2, 1, JointKind::kBall, {0, 0.18, 0.45}},
      {"left_hand", {0.08, 0.28, 0.08}, {0, 0.65, 0.45}, 1.6, 3, JointKind::kHinge, {0, 0.50, 0.45}},
      {"right_arm", {0.09, 0.30, 0.09}, {0, -0.34, 0.45}, 2.2, 1, JointKind::kBall, {0, -0.18, 0.45}},
      {"right_hand", {0.08, 0.28, 0.08}, {0, -0.65, 0.45}, 1.6, 5, JointKind::kHinge, {0, -0.50, 0.45}},
      {"left_thigh", {0.13, 0.13, 0.40}, {0, 0.09, -0.30}, 8.0, 0, JointKind::kBall, {0, 0.09, -0.09}},
      {"left_shank", {0.10, 0.10, 0.40}, {0, 0.09, -0.72}, 4.0, 7, JointKind::kHinge, {0, 0.09, -0.51}},
      {"right_thigh", {0.13, 0.13, 0.40}, {0, -0.09, -0.30}, 8.0, 0, JointKind::kBall, {0, -0.09, -0.09}},
      {"right_shank", {0.10, 0.10, 0.40}, {0, -0.09, -0.72}, 4.0, 9, JointKind::kHinge, {0, -0.09, -0.51}}};
  return parts;
}

// Elbows bend about z, knees about y, each from 0 to 2 rad one way.
void add_ragdoll(ModelBuilder& b, const std::string& prefix, const world::Pose& X_W) {
  std::vector<BodyId> ids;
  for (const Part& part : ragdoll_parts()) {
    const world::Pose X = X_W * at(part.centre.x(), part.centre.y(), part.centre.z());
    ids.push_back(b.add_box(prefix + part.name, part.lengths, part.mass_kg, X));
    if (part.parent < 0) continue;
    const bool is_elbow = part.anchor.z() > 0.0;
    const Vector3d axis = X_W.q * (is_elbow ? Vector3d::UnitZ() : Vector3d::UnitY());
    const BodyId parent = ids[static_cast<std::size_t>(part.parent)];
    world::Joint& joint =
        b.add_joint(prefix + part.name, part.kind, parent, ids.back(), X_W.p + X_W.q * part.anchor, axis);
    joint.friction = part.kind == JointKind::kHinge ? 1.0 : 0.0;
    joint.limited = part.kind == JointKind::kHinge;
    joint.lower = joint.limited ? -0.1 : 0.0;
    joint.upper = joint.limited ? 2.0 : 0.0;
  }
}

}  // namespace

void add_quadruped(ModelBuilder& b, const std::string& prefix, double x, double y) {
  const double height = (kUpper + kLower) * std::cos(kBend) + kFoot - kTouch;
  const BodyId trunk = b.add_box(prefix + "trunk", {0.5, 0.3, 0.15}, 6.0, at(x, y, height));
  for (const auto& [name, dx, dy] :
       {std::tuple("front_left", 0.3, 0.2), std::tuple("front_right", 0.3, -0.2),
        std::tuple("hind_left", -0.3, 0.2), std::tuple("hind_right", -0.3, -0.2)})
    add_leg(b, prefix + name, trunk, {x + dx, y + dy, height}, dx > 0.0 ? kBend : -kBend);
}

world::WorldModel standing_quadrupeds(const world::EngineSetting& engine, double tick_s, int count,
                                      Held held) {
  constexpr double kPitch = 2.0;  // m
  ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  b.add_ground();
  for (int i = 0; i < count; ++i)
    add_quadruped(b, "robot_" + std::to_string(i) + "_", kPitch * (i % kInARow), kPitch * (i / kInARow));
  hold(b, held);
  return b.model;
}

world::WorldModel standing_linkages(const world::EngineSetting& engine, double tick_s, int count) {
  constexpr double kHips = 0.3 + 2.0 * kFoot - kTouch;  // above the ground
  ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  b.add_ground();
  for (int i = 0; i < count; ++i) {
    const std::string name = "table_" + std::to_string(i);
    const double x = 2.0 * (i % kInARow), y = 2.0 * (i / kInARow);
    const BodyId top = b.add_box(name, {0.6, 0.4, 0.05}, 10.4, at(x, y, kHips));
    for (const double forward : {0.2, -0.2})
      for (const double left : {0.15, -0.15})
        add_parallelogram(b, name + (forward > 0.0 ? "_front" : "_hind") + (left > 0.0 ? "_left" : "_right"),
                          top, {x + forward, y + left, kHips});
  }
  return b.model;
}

world::WorldModel falling_ragdolls(const world::EngineSetting& engine, double tick_s, int count, int first) {
  constexpr double kPitch = 3.0, kHeight = 1.5;  // m
  ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  b.add_ground();
  for (int i = first; i < first + count; ++i)
    add_ragdoll(b, "doll_" + std::to_string(i) + "_",
                at(kPitch * (i % kInARow), kPitch * (i / kInARow), kHeight, 0.4 + 0.7 * i, {1.0, 0.5, 0.2}));
  return b.model;
}

}  // namespace visum::physics
