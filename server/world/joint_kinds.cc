#include "server/world/joint_kinds.h"

#include <numbers>

#include "server/world/turn.h"

namespace visum::world {
namespace {

// In the order of JointKind: {carries, drivable, is_angle, holds_anything}.
constexpr std::array kKinds{
    JointKindInfo{JointKind::kFixed, "fixed", true, false, false, true},
    JointKindInfo{JointKind::kHinge, "hinge", true, true, true, true},
    JointKindInfo{JointKind::kSlider, "slider", true, true, false, true},
    JointKindInfo{JointKind::kBall, "ball", true, false, false, true},
    JointKindInfo{JointKind::kUniversal, "universal", true, false, false, true},
    JointKindInfo{JointKind::kCylindrical, "cylindrical", true, false, false, true},
    JointKindInfo{JointKind::kScrew, "screw", true, true, true, true},
    JointKindInfo{JointKind::kPointOnPlane, "point_on_plane", false, false, false, true},
    JointKindInfo{JointKind::kPointOnLine, "point_on_line", false, false, false, true},
    JointKindInfo{JointKind::kPointOnCurve, "point_on_curve", false, false, false, true},
    JointKindInfo{JointKind::kSpring, "spring", false, false, false, false},
    JointKindInfo{JointKind::kTorsionSpring, "torsion_spring", false, false, true, false},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kKinds.size(); ++i)
    if (static_cast<std::size_t>(kKinds[i].kind) != i) return false;
  return true;
}
static_assert(in_order());

}  // namespace

std::span<const JointKindInfo> joint_kinds() {
  return kKinds;
}

const JointKindInfo& info(JointKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

Pose joint_motion(const Joint& joint, double position) {
  switch (joint.kind) {
    case JointKind::kHinge:
      return {Eigen::Vector3d::Zero(), turn_about(joint.axis_J, position)};
    case JointKind::kSlider:
      return {position * joint.axis_J, Eigen::Quaterniond::Identity()};
    case JointKind::kScrew:
      return {screw_lift(joint, position) * joint.axis_J, turn_about(joint.axis_J, position)};
    default:
      return {};
  }
}

double screw_lift(const Joint& joint, double angle) {
  return joint.pitch_m * angle / (2.0 * std::numbers::pi);
}

}  // namespace visum::world
