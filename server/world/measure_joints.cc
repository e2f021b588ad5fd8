#include <cmath>
#include <numbers>

#include "protocol/config/trig.h"
#include "server/world/joint_kinds.h"
#include "server/world/world_state.h"

namespace visum::world {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
const BodyState kStill{Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(),
                       Eigen::Vector3d::Zero()};

// A joint's frame as one of its bodies carries it, and that body's motion.
struct Side {
  Pose X_WJ;
  Eigen::Vector3d v_WJ = Eigen::Vector3d::Zero();  // of J's origin
  Eigen::Vector3d w_W = Eigen::Vector3d::Zero();
};

[[gnu::always_inline]] inline Side side_of(const WorldModel& model, const WorldState& state, BodyId id,
                                           const Pose& X_BJ) {
  if (!id.valid()) return {X_BJ};
  const Body& body = model.bodies[id.index()];
  const BodyState& motion = state.bodies[id.index()];
  const Pose X_WJ = link_pose(body, motion) * X_BJ;
  return {X_WJ, motion.v_WC + motion.w_WB.cross(X_WJ.p - motion.p_WC), motion.w_WB};
}

// The velocity of the child's J origin against the parent, in W.
Eigen::Vector3d relative_velocity(const Side& parent, const Side& child) {
  return child.v_WJ - parent.v_WJ - parent.w_W.cross(child.X_WJ.p - parent.X_WJ.p);
}

// q_WB * q_BJ. Spares the product where the joint's frame is turned as its body is, as most are.
[[gnu::always_inline]] inline const Eigen::Quaterniond& turned_by(const Eigen::Quaterniond& q_WB,
                                                                  const Eigen::Quaterniond& q_BJ,
                                                                  Eigen::Quaterniond& product) {
  if (q_BJ.w() == 1.0 && q_BJ.vec().isZero(0.0)) return q_WB;
  product = q_WB * q_BJ;
  return product;
}

// As std::round, but without a call in the usual case of less than half a turn.
double nearest(double turns) {
  return std::abs(turns) < 0.5 ? std::copysign(0.0, turns) : std::round(turns);
}

void measure_angle(const Joint& joint, const WorldState& world, double elapsed_s, JointState& state) {
  const BodyState& child = world.bodies[joint.child.index()];
  const BodyState& parent = joint.parent.valid() ? world.bodies[joint.parent.index()] : kStill;
  Eigen::Quaterniond parent_product, child_product;
  const Eigen::Quaterniond& p = turned_by(parent.q_WB, joint.X_PJ.q, parent_product);
  const Eigen::Quaterniond& c = turned_by(child.q_WB, joint.X_CJ.q, child_product);
  const Eigen::Vector3d u = p.vec(), t = c.vec(), &axis = joint.axis_J;
  // The quaternion conj(p) c, split into its share about the axis and the rest.
  const double along = axis.dot(p.w() * t - c.w() * u - u.cross(t));
  const double angle = 2.0 * config::arc_tangent(along, p.w() * c.w() + u.dot(t));
  const Eigen::Vector3d across = 2.0 * u.cross(axis);
  const Eigen::Vector3d axis_W = axis + p.w() * across + u.cross(across);
  const double velocity = axis_W.dot(child.w_WB - parent.w_WB);
  // Chooses among the angles that look the same the one nearest to where the mean velocity leads.
  const double expected = state.position + 0.5 * elapsed_s * (state.velocity + velocity);
  state.position = angle + kTurn * nearest((expected - angle) * (1.0 / kTurn));
  state.velocity = velocity;
}

// Forced inline, so that the compiler leaves out those members of a Side that the kind does not use.
[[gnu::always_inline]] inline void measure_distance(const Joint& joint, const Side& parent, const Side& child,
                                                    JointState& state) {
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

void measure(const WorldModel& model, const WorldState& world, const Joint& joint, JointState& state) {
  const auto parent = [&] { return side_of(model, world, joint.parent, joint.X_PJ); };
  const auto child = [&] { return side_of(model, world, joint.child, joint.X_CJ); };
  switch (joint.kind) {
    case JointKind::kSlider:
    case JointKind::kPointOnLine:
      return measure_distance(joint, parent(), child(), state);
    case JointKind::kSpring:
      return measure_length(parent(), child(), state);
    case JointKind::kPointOnCurve:
      return measure_place(joint, parent(), child(), state);
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
      measure_angle(joint, state, elapsed_s, state.joints[i]);
    else
      measure(model, state, joint, state.joints[i]);
  }
}

}  // namespace visum::world
