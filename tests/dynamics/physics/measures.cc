#include "tests/dynamics/physics/measures.h"

#include <algorithm>
#include <cmath>

#include "server/world/joint_kinds.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;
using world::Pose;

Pose joint_frame(const world::WorldModel& model, const world::WorldState& state, world::BodyId body,
                 const Pose& X_BJ) {
  if (!body.valid()) return X_BJ;
  return link_pose(model.bodies[body.index()], state.bodies[body.index()]) * X_BJ;
}

// The part of `d` (the child's point against the parent's, in the parent's J) by which the joint is open.
Vector3d held(const world::Joint& joint, const world::JointState& state, const Vector3d& d) {
  const Vector3d along = joint.axis_J * joint.axis_J.dot(d);
  switch (joint.kind) {
    case world::JointKind::kSlider:
    case world::JointKind::kCylindrical:
    case world::JointKind::kPointOnLine:
      return d - along;
    case world::JointKind::kScrew:
      return d - joint.axis_J * screw_lift(joint, state.position);
    case world::JointKind::kPointOnPlane:
      return along;
    case world::JointKind::kPointOnCurve:
      return d - joint.curve_J.at(joint.curve_J.nearest(d, state.position)).p;
    case world::JointKind::kSpring:
    case world::JointKind::kTorsionSpring:
      return Vector3d::Zero();
    default:
      return d;
  }
}

double spring_energy(const world::Joint& joint, const world::JointState& state) {
  if (info(joint.kind).holds_anything) return 0.0;
  return 0.5 * joint.stiffness * (state.position - joint.rest) * (state.position - joint.rest);
}

}  // namespace

Vector3d point_of(const world::WorldModel& model, const world::WorldState& state, world::BodyId body,
                  const Vector3d& p_B) {
  return link_pose(model.bodies[body.index()], state.bodies[body.index()]) * p_B;
}

Vector3d spin_of(const world::Body& body, const world::BodyState& state) {
  return state.q_WB * (body.inertia_C * (state.q_WB.conjugate() * state.w_WB));
}

double energy_of(const world::WorldModel& model, const world::WorldState& state) {
  double energy = 0.0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const auto& body = model.bodies[i];
    const auto& motion = state.bodies[i];
    if (body.fixed) continue;
    energy += 0.5 * body.mass_kg * motion.v_WC.squaredNorm() + 0.5 * motion.w_WB.dot(spin_of(body, motion)) -
              body.mass_kg * model.gravity.dot(motion.p_WC);
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    energy += spring_energy(model.joints[i], state.joints[i]);
  return energy;
}

double energy_scale(const world::WorldModel& model) {
  std::vector<double> path(model.bodies.size(), 0.0);  // to the body's joint
  double scale = 0.0;
  for (const auto& joint : model.joints) {
    const auto& body = model.bodies[joint.child.index()];
    double& length = path[joint.child.index()];
    if (joint.parent.valid()) length = path[joint.parent.index()] + (joint.X_PJ.p).norm();
    scale += body.mass_kg * model.gravity.norm() * (length + (body.p_BC - joint.X_CJ.p).norm());
  }
  return scale;
}

Vector3d momentum_of(const world::WorldModel& model, const world::WorldState& state) {
  Vector3d momentum = Vector3d::Zero();
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (!model.bodies[i].fixed) momentum += model.bodies[i].mass_kg * state.bodies[i].v_WC;
  return momentum;
}

Vector3d angular_momentum_of(const world::WorldModel& model, const world::WorldState& state) {
  Vector3d momentum = Vector3d::Zero();
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const auto& body = model.bodies[i];
    const auto& motion = state.bodies[i];
    if (!body.fixed) momentum += body.mass_kg * motion.p_WC.cross(motion.v_WC) + spin_of(body, motion);
  }
  return momentum;
}

MomentumDrift::MomentumDrift(const world::WorldModel& model, const world::WorldState& state)
    : start(momentum_of(model, state)), angular_start(angular_momentum_of(model, state)) {}

void MomentumDrift::look(const world::WorldModel& model, const world::WorldState& state) {
  linear = std::max(linear, (momentum_of(model, state) - start).norm() / start.norm());
  angular =
      std::max(angular, (angular_momentum_of(model, state) - angular_start).norm() / angular_start.norm());
}

double max_gap(const world::WorldModel& model, const world::WorldState& state) {
  double largest = 0.0;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const auto& joint = model.joints[i];
    const Pose parent = joint_frame(model, state, joint.parent, joint.X_PJ);
    const Pose child = joint_frame(model, state, joint.child, joint.X_CJ);
    const Vector3d d = parent.q.conjugate() * (child.p - parent.p);
    largest = std::max(largest, held(joint, state.joints[i], d).norm());
  }
  return largest;
}

}  // namespace visum::physics
