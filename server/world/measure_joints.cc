#include <cmath>
#include <numbers>

#include "protocol/config/trig.h"
#include "server/world/joint_kinds.h"
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

// Of the child's J origin against the parent, in W.
Eigen::Vector3d relative_velocity(const Side& parent, const Side& child) {
  return child.v_WJ - parent.v_WJ - parent.w_W.cross(child.X_WJ.p - parent.X_WJ.p);
}

// Likewise, as far as it turns.
struct Turn {
  Eigen::Quaterniond q_WJ;
  Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
};

Turn turn_of(const WorldState& state, BodyId id, const Pose& X_BJ) {
  if (!id.valid()) return {X_BJ.q};
  const BodyState& motion = state.bodies[id.index()];
  return {motion.q_WB * X_BJ.q, motion.w_WB};
}

void measure_angle(const Joint& joint, const Turn& parent, const Turn& child, double elapsed_s,
                   JointState& state) {
  const Eigen::Quaterniond turned = parent.q_WJ.conjugate() * child.q_WJ;
  const double angle = 2.0 * config::arc_tangent(joint.axis_J.dot(turned.vec()), turned.w());
  const double velocity = (parent.q_WJ * joint.axis_J).dot(child.w_W - parent.w_W);
  // Of the angles that look the same, the one nearest to where the mean velocity leads.
  const double expected = state.position + 0.5 * elapsed_s * (state.velocity + velocity);
  state.position = angle + kTurn * std::round((expected - angle) / kTurn);
  state.velocity = velocity;
}

void measure_distance(const Joint& joint, const Side& parent, const Side& child, JointState& state) {
  const Eigen::Vector3d axis_W = parent.X_WJ.q * joint.axis_J;
  state.position = axis_W.dot(child.X_WJ.p - parent.X_WJ.p);
  state.velocity = axis_W.dot(relative_velocity(parent, child));
}

void measure_length(const Side& parent, const Side& child, JointState& state) {
  const Eigen::Vector3d along = child.X_WJ.p - parent.X_WJ.p;
  state.position = along.norm();
  state.velocity = state.position > 0.0 ? along.dot(relative_velocity(parent, child)) / state.position : 0.0;
}

void measure_place(const Joint& joint, const Side& parent, const Side& child, JointState& state) {
  const Eigen::Quaterniond to_J = parent.X_WJ.q.conjugate();
  state.position = joint.curve_J.nearest(to_J * (child.X_WJ.p - parent.X_WJ.p), state.position);
  const Eigen::Vector3d tangent = joint.curve_J.at(state.position).tangent;
  state.velocity = tangent.dot(to_J * relative_velocity(parent, child)) / tangent.squaredNorm();
}

void measure(const Joint& joint, const Side& parent, const Side& child, JointState& state) {
  switch (joint.kind) {
    case JointKind::kSlider:
    case JointKind::kPointOnLine:
      return measure_distance(joint, parent, child, state);
    case JointKind::kSpring:
      return measure_length(parent, child, state);
    case JointKind::kPointOnCurve:
      return measure_place(joint, parent, child, state);
    case JointKind::kHinge:
    case JointKind::kScrew:
    case JointKind::kTorsionSpring:
    case JointKind::kFixed:
    case JointKind::kBall:
    case JointKind::kUniversal:
    case JointKind::kCylindrical:
    case JointKind::kPointOnPlane:
      state.position = state.velocity = 0.0;
  }
}

}  // namespace

void measure_joints(const WorldModel& model, WorldState& state, double elapsed_s) {
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    if (info(joint.kind).is_angle)
      measure_angle(joint, turn_of(state, joint.parent, joint.X_PJ), turn_of(state, joint.child, joint.X_CJ),
                    elapsed_s, state.joints[i]);
    else
      measure(joint, side_of(model, state, joint.parent, joint.X_PJ),
              side_of(model, state, joint.child, joint.X_CJ), state.joints[i]);
  }
}

}  // namespace visum::world
