#include "server/programs/joint_loads.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/world/joint_kinds.h"
#include "server/world/joint_tree.h"

namespace visum::programs {
namespace {

using world::Body;
using world::Joint;
using world::JointId;
using world::JointKind;
using world::Pose;
using world::WorldModel;

constexpr double kQuarterTurn = std::numbers::pi / 2.0;
constexpr double kQuarter = 0.25;   // of a slider's way
constexpr double kRounding = 1e-9;  // N·m or N
constexpr double kFreeWay_m = 1.0;  // of a slider without stops

// How the child lies to the parent when the joint is at q.
Pose across(const WorldModel& model, const Joint& joint, double q) {
  Pose motion;
  if (joint.kind == JointKind::kSlider)
    motion.p = q * joint.axis_J;
  else if (joint.kind == JointKind::kHinge)
    motion.q = Eigen::AngleAxisd(q, joint.axis_J);
  if (world::is_drivable(joint.kind) && joint.kind != JointKind::kScrew)
    return joint.X_PJ * motion * joint.X_CJ.inverse();
  // Any other joint stays as it is at the start.
  const Pose parent = joint.parent.valid() ? model.bodies[joint.parent.index()].X_WB : Pose{};
  return parent.inverse() * model.bodies[joint.child.index()].X_WB;
}

// The bodies in an order in which parents come first, with the joint that carries each.
struct Tree {
  explicit Tree(const WorldModel& model) : carriers(world::carrying_joints(model)) {
    for (const Joint& joint : model.joints)
      if (carries(joint, model)) order.push_back(joint.child.index());
  }
  bool carries(const Joint& joint, const WorldModel& model) const {
    const JointId carrier = carriers[joint.child.index()];
    return carrier.valid() && &model.joints[carrier.index()] == &joint;
  }
  std::vector<JointId> carriers;
  std::vector<std::size_t> order;
};

std::vector<Pose> poses_at(const WorldModel& model, const Tree& tree, const std::vector<double>& positions) {
  std::vector<Pose> poses;
  for (const Body& body : model.bodies) poses.push_back(body.X_WB);
  for (const std::size_t child : tree.order) {
    const std::size_t index = tree.carriers[child].index();
    const Joint& joint = model.joints[index];
    const Pose parent = joint.parent.valid() ? poses[joint.parent.index()] : Pose{};
    poses[child] = parent * across(model, joint, positions[index]);
  }
  return poses;
}

// True for each body that moves with the joint.
std::vector<bool> moved_by(const WorldModel& model, const Tree& tree, const Joint& joint) {
  std::vector<bool> moved(model.bodies.size(), false);
  moved[joint.child.index()] = true;
  for (const std::size_t child : tree.order) {
    const Joint& carrier = model.joints[tree.carriers[child].index()];
    if (carrier.parent.valid() && moved[carrier.parent.index()]) moved[child] = true;
  }
  return moved;
}

JointLoad load_at(const WorldModel& model, const Joint& joint, const std::vector<bool>& moved,
                  const std::vector<Pose>& poses) {
  const Pose X_WJ = poses[joint.child.index()] * joint.X_CJ;
  const Eigen::Vector3d axis = X_WJ.q * joint.axis_J;
  const bool slider = joint.kind == JointKind::kSlider;
  JointLoad load;
  double gravity = 0.0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const Body& body = model.bodies[i];
    if (!moved[i] || body.fixed) continue;
    const Eigen::Vector3d arm = poses[i] * body.p_BC - X_WJ.p;
    const Eigen::Vector3d weight = body.mass_kg * model.gravity;
    const Eigen::Vector3d axis_B = poses[i].q.conjugate() * axis;
    gravity += slider ? axis.dot(weight) : axis.dot(arm.cross(weight));
    load.inertia += slider ? body.mass_kg
                           : axis_B.dot(body.inertia_C * axis_B) +
                                 body.mass_kg * (arm - axis.dot(arm) * axis).squaredNorm();
  }
  load.gravity = std::abs(gravity) < kRounding ? 0.0 : std::abs(gravity);
  return load;
}

double inside(const Joint& joint, double q) {
  return joint.limited ? std::clamp(q, joint.lower, joint.upper) : q;
}

double step_of(const Joint& joint) {
  if (joint.kind != JointKind::kSlider) return kQuarterTurn;
  return joint.limited ? kQuarter * (joint.upper - joint.lower) : kFreeWay_m;
}

// The poses of worst_loads(), as positions of all joints of the model.
std::vector<std::vector<double>> tried(const WorldModel& model, const std::vector<JointId>& joints) {
  std::vector<double> start, zero;
  for (const Joint& joint : model.joints) {
    start.push_back(joint.initial_position);
    zero.push_back(joint.initial_position);
  }
  for (const JointId id : joints) zero[id.index()] = inside(model.joints[id.index()], 0.0);
  std::vector<double> middle = zero;
  for (const JointId id : joints) {
    const Joint& joint = model.joints[id.index()];
    if (joint.limited) middle[id.index()] = 0.5 * (joint.lower + joint.upper);
  }
  std::vector<std::vector<double>> all{start, zero, middle};
  for (const JointId id : joints) {
    const Joint& joint = model.joints[id.index()];
    for (const double side : {-1.0, 1.0}) {
      all.push_back(zero);
      all.back()[id.index()] = inside(joint, zero[id.index()] + side * step_of(joint));
    }
  }
  return all;
}

}  // namespace

std::vector<JointLoad> worst_loads(const WorldModel& model, const std::vector<JointId>& joints) {
  const Tree tree(model);
  std::vector<std::vector<bool>> moved;
  for (const JointId id : joints) moved.push_back(moved_by(model, tree, model.joints[id.index()]));
  std::vector<JointLoad> worst(joints.size());
  for (const auto& positions : tried(model, joints)) {
    const auto poses = poses_at(model, tree, positions);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const JointLoad load = load_at(model, model.joints[joints[i].index()], moved[i], poses);
      worst[i].inertia = std::max(worst[i].inertia, load.inertia);
      worst[i].gravity = std::max(worst[i].gravity, load.gravity);
    }
  }
  return worst;
}

}  // namespace visum::programs
