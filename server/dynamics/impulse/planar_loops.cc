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

// The axis of the first hinge on the way from a node to the root, in the node's P axes; zero: there is none.
Vector3d Mechanism::first_hinge_above(int node) const {
  std::vector<const JointSpec*> below;
  for (; node >= 0; node = tree_.node(static_cast<std::size_t>(node)).parent) {
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

Vector3d Mechanism::find_normal(std::size_t i) const {
  const JointSpec& loop = loops_[i];
  if (loop.kind != JointKind::kHinge && loop.kind != JointKind::kSlider) return Vector3d::Zero();
  auto [a, b] = std::pair(loop_ends_[i].node_a, loop_ends_[i].node_b);
  Vector3d normal = loop.kind == JointKind::kHinge ? loop.axis_b : first_hinge_above(b);
  if (normal.isZero(0.0)) normal = onto_b(loop, first_hinge_above(a));
  if (normal.isZero(0.0) || !moves_in_plane(loop, normal)) return Vector3d::Zero();
  // Parents come before children, so the later of two nodes cannot be above the other.
  Vector3d n_a = onto_a(loop, normal), n_b = normal;
  while (a != b) {
    int& node = a > b ? a : b;
    Vector3d& n = a > b ? n_a : n_b;
    const JointSpec* joint = carrying(static_cast<std::size_t>(node));
    if (joint == nullptr || !moves_in_plane(*joint, n)) return Vector3d::Zero();
    n = onto_a(*joint, n);
    node = tree_.node(static_cast<std::size_t>(node)).parent;
  }
  return n_a.cross(n_b).norm() <= kParallel ? normal : Vector3d::Zero();
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
