#include <cmath>
#include <numbers>

#include "server/world/world_state.h"

namespace visum::world {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// A joint's frame as one of its bodies carries it, and that body's motion.
struct Side {
  Pose X_WJ;
  Eigen::Vector3d v_WJ = Eigen::Vector3d::Zero();  // of J's origin
  Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
};

Side side_of(const WorldModel& model, const WorldState& state, BodyId id, const Pose& X_BJ) {
  if (!id.valid()) return {X_BJ};
  const Body& body = model.bodies[id.index()];
  const BodyState& motion = state.bodies[id.index()];
  const Pose X_WJ = link_pose(body, motion) * X_BJ;
  return {X_WJ, motion.v_WC + motion.w_WB.cross(X_WJ.p - motion.p_WC), motion.w_WB};
}

void measure_hinge(const Joint& joint, const Side& parent, const Side& child, JointState& state) {
  const Eigen::Quaterniond turned = parent.X_WJ.q.conjugate() * child.X_WJ.q;
  const double angle = 2.0 * std::atan2(joint.axis_J.dot(turned.vec()), turned.w());
  // The nearest of the angles that look the same: a tick turns by far less than half a turn.
  state.position = angle + kTurn * std::round((state.position - angle) / kTurn);
  state.velocity = (parent.X_WJ.q * joint.axis_J).dot(child.w_W - parent.w_W);
}

void measure_slider(const Joint& joint, const Side& parent, const Side& child, JointState& state) {
  const Eigen::Vector3d axis_W = parent.X_WJ.q * joint.axis_J;
  const Eigen::Vector3d offset = child.X_WJ.p - parent.X_WJ.p;
  state.position = axis_W.dot(offset);
  state.velocity = axis_W.dot(child.v_WJ - parent.v_WJ - parent.w_W.cross(offset));
}

}  // namespace

void measure_joints(const WorldModel& model, WorldState& state) {
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    const Side parent = side_of(model, state, joint.parent, joint.X_PJ);
    const Side child = side_of(model, state, joint.child, joint.X_CJ);
    switch (joint.kind) {
      case JointKind::kHinge:
        measure_hinge(joint, parent, child, state.joints[i]);
        break;
      case JointKind::kSlider:
        measure_slider(joint, parent, child, state.joints[i]);
        break;
      case JointKind::kFixed:
        state.joints[i].position = state.joints[i].velocity = 0.0;
        break;
    }
  }
}

}  // namespace visum::world
