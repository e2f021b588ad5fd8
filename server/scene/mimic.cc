#include "server/scene/mimic.h"

#include <algorithm>
#include <cmath>

#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

constexpr double kMostTurns = 1e6;  // bound of multiplier and offset

bool has_axis(const RobotJoint* joint) {
  return joint != nullptr && world::is_drivable(joint->joint.kind);
}

// True if the joint follows itself in the end.
bool is_in_circle(const RobotModel& model, const RobotJoint& start) {
  const RobotJoint* joint = &start;
  for (std::size_t steps = 0; steps <= model.joints.size(); ++steps) {
    joint = joint->mimic ? find_joint(model, joint->mimic->leader) : nullptr;
    if (joint == nullptr) return false;
    if (joint == &start) return true;
  }
  return false;  // it follows a circle that it is no part of, which is opened elsewhere
}

std::string fault_of(const RobotModel& model, const RobotJoint& joint) {
  const Mimic& mimic = *joint.mimic;
  if (!has_axis(&joint)) return "it has no axis to drive";
  if (!(std::abs(mimic.multiplier) < kMostTurns && std::abs(mimic.offset) < kMostTurns))
    return "its multiplier or offset is beyond 1e6";
  if (!has_axis(find_joint(model, mimic.leader)))
    return "there is no movable joint '" + mimic.leader + "' to follow";
  return is_in_circle(model, joint) ? "it would follow itself" : "";
}

}  // namespace

const RobotJoint* find_joint(const RobotModel& model, const std::string& name) {
  const auto found = std::find_if(model.joints.begin(), model.joints.end(),
                                  [&](const RobotJoint& joint) { return joint.joint.name == name; });
  return found == model.joints.end() ? nullptr : &*found;
}

void follow_joints(RobotModel& model) {
  for (RobotJoint& joint : model.joints) {
    if (!joint.mimic) continue;
    const std::string fault = fault_of(model, joint);
    if (fault.empty()) continue;
    model.losses.push_back(
        {"joint '" + joint.joint.name + "' moves on its own, without its <mimic>: " + fault,
         joint.mimic->line, joint.file});
    joint.mimic.reset();
  }
}

}  // namespace visum::scene
