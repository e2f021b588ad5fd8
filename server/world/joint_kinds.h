// The kinds of joint: what each kind holds, and which coordinate it measures. P is the joint's point on the
// child (the origin of X_CJ), a the axis fixed to the parent, b the axis fixed to the child. Constant; any
// thread.
//
//   kind            holds                                        coordinate (JointState)
//   fixed           all six                                      -
//   hinge           P, direction of the axis                     angle, rad
//   slider          orientation, P on the axis                   distance along a, m
//   ball            P                                            -
//   universal       P, angle between a and b (axis2_J)           -
//   cylindrical     P on the axis, direction of the axis         -
//   screw           as cylindrical, and distance = pitch × turns angle, rad
//   point_on_plane  P in the plane through J, normal a           -
//   point_on_line   P on the line through J along a              distance along a, m
//   point_on_curve  P on the curve                               the curve's parameter, m
//   spring          nothing: stiffness (l - rest) and damping    length l, m
//   torsion_spring  nothing: about a, of a joint beside it       angle, rad
#pragma once

#include <span>

#include "server/world/world_model.h"

namespace visum::world {

struct JointKindInfo {
  JointKind kind;
  const char* name;     // in scene files and on the wire
  bool carries;         // a body's first joint of such a kind carries it: these joints make the tree
  bool drivable;        // has one axis that may have stops, friction, damping and a drive
  bool is_angle;        // the coordinate is an angle
  bool holds_anything;  // false: the joint is only a force
};

std::span<const JointKindInfo> joint_kinds();
const JointKindInfo& info(JointKind kind);

inline bool carries(JointKind kind) {
  return info(kind).carries;
}
inline bool is_drivable(JointKind kind) {
  return info(kind).drivable;
}

// How the child's J moves against the parent's where a drivable joint stands at this position; none for other
// kinds.
Pose joint_motion(const Joint& joint, double position);

// How far a screw has moved along its axis at this angle (rad), m.
double screw_lift(const Joint& joint, double angle);

}  // namespace visum::world
