#include "server/dynamics/impulse/joint_spec.h"

#include <cmath>

#include "protocol/config/trig.h"
#include "server/dynamics/impulse/joints/ball.h"
#include "server/dynamics/impulse/joints/cylindrical.h"
#include "server/dynamics/impulse/joints/fixed.h"
#include "server/dynamics/impulse/joints/hinge.h"
#include "server/dynamics/impulse/joints/point_on_curve.h"
#include "server/dynamics/impulse/joints/point_on_line.h"
#include "server/dynamics/impulse/joints/point_on_plane.h"
#include "server/dynamics/impulse/joints/screw.h"
#include "server/dynamics/impulse/joints/slider.h"
#include "server/dynamics/impulse/joints/universal.h"
#include "server/world/joint_kinds.h"

namespace visum::dynamics::impulse {
namespace {

using world::JointKind;

constexpr double kTurn = 6.28318530717958647693;
const Matrix3d kStill = Matrix3d::Identity();  // axes of anything that does not move

// The pose from given positions and orientations; A may be something that does not move.
JointPose pose_of(const JointSpec& joint, const std::vector<Vector3d>& x, const std::vector<Matrix3d>& R,
                  double position) {
  JointPose pose;
  const auto b = static_cast<std::size_t>(joint.b);
  if (joint.a >= 0) {
    const auto a = static_cast<std::size_t>(joint.a);
    pose.Ra = &R[a];
    pose.pa = x[a] + R[a] * joint.point_a;
    pose.a = R[a] * joint.axis_a;
  } else {
    pose.Ra = &kStill;
    pose.pa = joint.point_a;
    pose.a = joint.axis_a;
  }
  pose.Rb = &R[b];
  pose.pb = x[b] + R[b] * joint.point_b;
  pose.b = R[b] * joint.axis_b;
  find_angle(joint, position, pose);
  return pose;
}

}  // namespace

// Springs hold nothing.
Held held_directions(const JointSpec& joint, const JointPose& pose) {
  switch (joint.kind) {
    case JointKind::kFixed:
      return fixed::held(joint, pose);
    case JointKind::kHinge:
      return hinge::held(joint, pose);
    case JointKind::kSlider:
      return slider::held(joint, pose);
    case JointKind::kBall:
      return ball::held(joint, pose);
    case JointKind::kUniversal:
      return universal::held(joint, pose);
    case JointKind::kCylindrical:
      return cylindrical::held(joint, pose);
    case JointKind::kScrew:
      return screw::held(joint, pose);
    case JointKind::kPointOnPlane:
      return point_on_plane::held(joint, pose);
    case JointKind::kPointOnLine:
      return point_on_line::held(joint, pose);
    case JointKind::kPointOnCurve:
      return point_on_curve::held(joint, pose);
    case JointKind::kSpring:
    case JointKind::kTorsionSpring:
      break;
  }
  return {};
}

// A fixed joint and the kinds that cannot carry a body have no free directions.
Motion motion_directions(const JointSpec& joint, const JointPose& pose) {
  switch (joint.kind) {
    case JointKind::kHinge:
      return hinge::motion(joint, pose);
    case JointKind::kSlider:
      return slider::motion(joint, pose);
    case JointKind::kBall:
      return ball::motion(joint, pose);
    case JointKind::kUniversal:
      return universal::motion(joint, pose);
    case JointKind::kCylindrical:
      return cylindrical::motion(joint, pose);
    case JointKind::kScrew:
      return screw::motion(joint, pose);
    default:
      return {};
  }
}

Gap joint_gap(const JointSpec& joint, const JointPose& pose) {
  switch (joint.kind) {
    case JointKind::kFixed:
      return fixed::gap(joint, pose);
    case JointKind::kHinge:
      return hinge::gap(joint, pose);
    case JointKind::kSlider:
      return slider::gap(joint, pose);
    case JointKind::kBall:
      return ball::gap(joint, pose);
    case JointKind::kUniversal:
      return universal::gap(joint, pose);
    case JointKind::kCylindrical:
      return cylindrical::gap(joint, pose);
    case JointKind::kScrew:
      return screw::gap(joint, pose);
    case JointKind::kPointOnPlane:
      return point_on_plane::gap(joint, pose);
    case JointKind::kPointOnLine:
      return point_on_line::gap(joint, pose);
    case JointKind::kPointOnCurve:
      return point_on_curve::gap(joint, pose);
    case JointKind::kSpring:
    case JointKind::kTorsionSpring:
      break;
  }
  return {};
}

// The direction is the axis as A carries it.
AxisDirection axis_direction(const JointSpec& joint, const JointPose& pose) {
  if (world::info(joint.kind).is_angle) return {pose.a, Vector3d::Zero()};
  return {Vector3d::Zero(), pose.a};
}

JointSpec make_spec(const world::WorldModel& model, const Bodies& bodies, world::JointId id) {
  const world::Joint& joint = model.joints[id.index()];
  JointSpec spec;
  spec.kind = joint.kind;
  spec.id = id;
  spec.model = &joint;
  spec.a = bodies.number(joint.parent);
  spec.b = bodies.number(joint.child);
  spec.lift = world::screw_lift(joint, 1.0);
  // Point and frame of the joint on one body, or in W where this engine does not move the body.
  const auto seat = [&](world::BodyId body, int number, const world::Pose& X_BJ, Vector3d& point,
                        Matrix3d& frame) {
    // Not a body of this engine: the joint has a fixed place in W.
    if (number < 0) {
      const world::Pose X_WJ = (body.valid() ? model.bodies[body.index()].X_WB : world::Pose{}) * X_BJ;
      point = X_WJ.p;
      frame = X_WJ.q.toRotationMatrix();
      return;
    }
    const Quaterniond q_PB = bodies.constants[static_cast<std::size_t>(number)].q_BP.conjugate();
    point = q_PB * (X_BJ.p - model.bodies[body.index()].p_BC);
    frame = (q_PB * X_BJ.q).toRotationMatrix();
  };
  seat(joint.parent, spec.a, joint.X_PJ, spec.point_a, spec.frame_a);
  seat(joint.child, spec.b, joint.X_CJ, spec.point_b, spec.frame_b);
  // The axis, the direction of angle zero and the second axis, as each body carries them.
  spec.axis_a = spec.frame_a * joint.axis_J;
  spec.axis_b = spec.frame_b * joint.axis_J;
  const Vector3d zero_J = across(joint.axis_J).first;
  spec.zero_a = spec.frame_a * zero_J;
  spec.zero_b = spec.frame_b * zero_J;
  spec.axis2_b = spec.frame_b * joint.axis2_J;
  return spec;
}

JointPose pose_now(const JointSpec& joint, const Bodies& bodies, double position) {
  return pose_of(joint, bodies.x, bodies.R, position);
}

JointPose pose_ahead(const JointSpec& joint, const Bodies& bodies, const world::JointState& last, double h) {
  return pose_of(joint, bodies.x1, bodies.R1, position_ahead(joint, last, h));
}

// A screw lifts by its whole turn, even if it is more than half a turn.
double position_ahead(const JointSpec& joint, const world::JointState& last, double h) {
  return last.position + (joint.kind == JointKind::kScrew ? h * last.velocity : 0.0);
}

void find_angle(const JointSpec& joint, double position, JointPose& pose) {
  if (joint.kind == JointKind::kScrew) pose.angle = joint_angle(joint, pose, position);
  if (joint.kind == JointKind::kPointOnCurve) pose.angle = point_on_curve::parameter(joint, pose, position);
}

double joint_angle(const JointSpec& joint, const JointPose& pose, double near) {
  const Vector3d u = *pose.Ra * joint.zero_a, w = *pose.Rb * joint.zero_b;
  const double angle = config::arc_tangent(pose.a.dot(u.cross(w)), u.dot(w));
  // The arc tangent gives one turn; whole turns are added to come near the expected angle.
  const double off = near - angle;
  return std::abs(off) < 0.5 * kTurn ? angle : angle + kTurn * std::round(off / kTurn);
}

}  // namespace visum::dynamics::impulse
