// Loops in a plane, as of four-bars, scissors and cranks with pistons. Hinges across the plane and sliders in
// it move nothing out of it, and an impulse out of it passes them whole, until those of the loop's two ends
// meet and cancel. So the tree cannot move such a loop's rows out of the plane, and they need not be there.
// This follows from how the joints sit on their bodies, and holds in any pose.
#include "server/dynamics/impulse/joints/directions.h"
#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {
namespace {

using world::JointKind;

constexpr double kParallel = 1e-6;  // rad; rows that are off by this have 1e-12 of their response, and would
                                    // be left out as dependent (loop_factor.h)

// From B's P axes to A's, for directions that the joint does not turn.
Vector3d onto_a(const JointSpec& joint, const Vector3d& n) {
  return joint.frame_a * (joint.frame_b.transpose() * n);
}
Vector3d onto_b(const JointSpec& joint, const Vector3d& n) {
  return joint.frame_b * (joint.frame_a.transpose() * n);
}

// True if B moves against A in the plane across n alone, n in B's axes.
bool moves_in_plane(const JointSpec& joint, const Vector3d& n) {
  switch (joint.kind) {
    case JointKind::kHinge:
      return joint.axis_b.cross(n).norm() <= kParallel;
    case JointKind::kSlider:
      return std::abs(joint.axis_b.dot(n)) <= kParallel;
    case JointKind::kFixed:
      return true;
    default:
      return false;
  }
}

}  // namespace

// The node where the ways from two nodes to the root meet; -1: none. Parents come before children, so the
// later of two nodes cannot be above the other.
int Mechanism::meeting_of(int a, int b) const {
  while (a != b) {
    int& later = a > b ? a : b;
    later = tree_.node(static_cast<std::size_t>(later)).parent;
  }
  return a;
}

// The axis of the first hinge on the way from a node up to another one, in the node's P axes; zero: there is
// none.
Vector3d Mechanism::first_hinge_above(int node, int end) const {
  std::vector<const JointSpec*> below;
  for (; node != end; node = tree_.node(static_cast<std::size_t>(node)).parent) {
    const JointSpec* joint = carrying(static_cast<std::size_t>(node));
    if (joint == nullptr) break;
    if (joint->kind != JointKind::kHinge) {
      below.push_back(joint);
      continue;
    }
    Vector3d axis = joint->axis_b;
    for (; !below.empty(); below.pop_back()) axis = onto_b(*below.back(), axis);
    return axis;
  }
  return Vector3d::Zero();
}

// The normal in the axes of the node `end`, from a node below it; nothing: a joint leads out of the plane.
std::optional<Vector3d> Mechanism::follow_normal(int node, Vector3d n, int end) const {
  for (; node != end; node = tree_.node(static_cast<std::size_t>(node)).parent) {
    const JointSpec* joint = carrying(static_cast<std::size_t>(node));
    if (joint == nullptr || !moves_in_plane(*joint, n)) return std::nullopt;
    n = onto_a(*joint, n);
  }
  return n;
}

Vector3d Mechanism::find_normal(std::size_t i) const {
  const JointSpec& loop = loops_[i];
  if (loop.kind != JointKind::kHinge && loop.kind != JointKind::kSlider) return Vector3d::Zero();
  const int a = loop_ends_[i].node_a, b = loop_ends_[i].node_b, end = meeting_of(a, b);
  Vector3d normal = loop.kind == JointKind::kHinge ? loop.axis_b : first_hinge_above(b, end);
  if (normal.isZero(0.0)) normal = onto_b(loop, first_hinge_above(a, end));
  if (normal.isZero(0.0) || !moves_in_plane(loop, normal)) return Vector3d::Zero();
  const std::optional<Vector3d> by_a = follow_normal(a, onto_a(loop, normal), end);
  const std::optional<Vector3d> by_b = follow_normal(b, normal, end);
  const bool planar = by_a && by_b && by_a->cross(*by_b).norm() <= kParallel;
  return planar ? normal : Vector3d::Zero();
}

Held Mechanism::held_by_loop(std::size_t i) const {
  const JointSpec& loop = loops_[i];
  const JointPose& pose = loop_pose(i);
  if (!is_planar(i)) return held_directions(loop, pose);
  const Vector3d n = *pose.Rb * loop_normals_[i];
  Held rows;
  if (loop.kind == JointKind::kHinge) {
    add_shifts_across(n, rows);
  } else {
    rows.add(n, Vector3d::Zero());
    rows.add(Vector3d::Zero(), n.cross(pose.a));
  }
  return rows;
}

}  // namespace visum::dynamics::impulse
