#include <cmath>
#include <unordered_set>

#include "server/world/fault_text.h"
#include "server/world/joint_kinds.h"

namespace visum::world {
namespace {

constexpr double kMaxStiffness = 1e12;

// The world itself and fixed bodies stand still without a joint.
bool is_ground(const WorldModel& model, BodyId body) {
  return !body.valid() || model.bodies[body.index()].fixed;
}

std::string ends_fault(const WorldModel& model, const Joint& joint) {
  if (!joint.child.valid() || joint.child.index() >= model.bodies.size()) return "has no child body";
  if (joint.parent.valid() && joint.parent.index() >= model.bodies.size())
    return "has a parent that does not exist";
  if (joint.parent == joint.child) return "connects a body with itself";
  if (is_ground(model, joint.child)) return "has a child that is fixed";
  if (is_ground(model, joint.parent)) return "";
  if (const Body& parent = model.bodies[joint.parent.index()], &child = model.bodies[joint.child.index()];
      parent.kinematic != child.kinematic)
    return "connects " + quoted((parent.kinematic ? parent : child).name) +
           ", which is kinematic, with a body that is not";
  const bool same = model.bodies[joint.parent.index()].engine == model.bodies[joint.child.index()].engine;
  return same ? "" : "connects bodies of two engines";
}

std::string stops_fault(const Joint& joint) {
  if (joint.limited && !is_drivable(joint.kind)) return "has stops, which only a hinge, slider or screw has";
  if (!is_in_range(joint.initial_position, -kMaxMagnitude, kMaxMagnitude))
    return "has an initial position that is not finite or beyond 1e6";
  if (!joint.limited) return "";
  const bool ordered = is_in_range(joint.lower, -kMaxMagnitude, kMaxMagnitude) &&
                       is_in_range(joint.upper, joint.lower, kMaxMagnitude);
  if (!ordered) return "has stops that are not finite or not in order";
  if (!is_in_range(joint.stop_restitution, 0.0, 1.0)) return "needs a stop_restitution from 0 to 1";
  if (!is_in_range(joint.initial_position, joint.lower, joint.upper)) return "starts beyond its stops";
  return "";
}

constexpr double kPerpendicular = 1e-6;
constexpr double kOnCurveM = 1e-6;

std::string spring_fault(const Joint& joint) {
  if (!is_in_range(joint.stiffness, 0.0, kMaxStiffness)) return "needs a stiffness between 0 and 1e12";
  if (!is_in_range(joint.rest, joint.kind == JointKind::kSpring ? 0.0 : -kMaxMagnitude, kMaxMagnitude))
    return "needs a rest within 1e6, and no negative length";
  return "";
}

std::string curve_fault(const Joint& joint) {
  if (joint.curve_J.empty()) return "needs a curve of at least 2 points (3 if closed), neighbours apart";
  for (const Eigen::Vector3d& point : joint.curve_J.points()) {
    if (!is_placed(point)) return "has a point of its curve that is not finite or beyond 1e6 m";
  }
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const double off = joint.curve_J.at(joint.curve_J.nearest(origin)).p.norm();
  return off > kOnCurveM ? "has a curve that does not pass through the joint's place" : "";
}

std::string kind_fault(const Joint& joint) {
  switch (joint.kind) {
    case JointKind::kUniversal:
      if (!is_unit(joint.axis2_J.norm())) return "has a second axis that is not of unit length";
      return std::abs(joint.axis_J.dot(joint.axis2_J)) > kPerpendicular
                 ? "has axes that are not perpendicular"
                 : "";
    case JointKind::kScrew:
      return is_in_range(std::abs(joint.pitch_m), 0.0, kMaxMagnitude) ? "" : "needs a pitch within 1e6 m";
    case JointKind::kPointOnCurve:
      return curve_fault(joint);
    case JointKind::kSpring:
    case JointKind::kTorsionSpring:
      return spring_fault(joint);
    default:
      return "";
  }
}

std::string joint_fault(const WorldModel& model, const Joint& joint) {
  if (joint.name.empty()) return "has no name";
  if (const std::string fault = ends_fault(model, joint); !fault.empty()) return fault;
  for (const Pose& pose : {joint.X_PJ, joint.X_CJ}) {
    if (const std::string fault = pose_fault(pose); !fault.empty()) return fault;
  }
  if (!is_unit(joint.axis_J.norm())) return "has an axis that is not of unit length";
  if (!is_in_range(joint.friction, 0.0, kMaxMagnitude)) return "needs a friction between 0 and 1e6";
  if (!is_in_range(joint.damping, 0.0, kMaxMagnitude)) return "needs a damping between 0 and 1e6";
  if (const std::string fault = kind_fault(joint); !fault.empty()) return fault;
  return stops_fault(joint);
}

// Checks the order of the joints that carry bodies: parents first. That order also rules out a tree that
// bites its own tail. A body's second joint closes a loop and may stand anywhere after its first.
class TreeOrder {
 public:
  explicit TreeOrder(const WorldModel& model) : hangs_(model.bodies.size()), carries_(model.bodies.size()) {}

  // True if the joint may stand here, after those that were accepted before.
  bool accepts(const Joint& joint) {
    if (!carries(joint.kind)) return true;
    if (!hangs_[joint.child.index()] && carries_[joint.child.index()]) return false;
    hangs_[joint.child.index()] = true;
    if (joint.parent.valid()) carries_[joint.parent.index()] = true;
    return true;
  }

 private:
  std::vector<bool> hangs_, carries_;
};

}  // namespace

std::string fault_of(const WorldModel& model, const Joint& joint) {
  const std::string fault = joint_fault(model, joint);
  return fault.empty() ? "" : "joint " + quoted(joint.name) + " " + fault;
}

std::string find_joint_fault(const WorldModel& model) {
  std::unordered_set<std::string> names;
  TreeOrder order(model);
  for (const Joint& joint : model.joints) {
    if (std::string fault = fault_of(model, joint); !fault.empty()) return fault;
    if (!order.accepts(joint))
      return "joint " + quoted(joint.name) + " stands after a joint below it, or closes a cycle";
    if (!names.insert(joint.name).second) return "there are two joints called " + quoted(joint.name);
  }
  return "";
}

}  // namespace visum::world
