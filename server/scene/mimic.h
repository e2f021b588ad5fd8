// Joints of a model that follow other joints of it: checks who follows whom.
#pragma once

#include <string>

#include "server/scene/robot_model.h"

namespace visum::scene {

// Takes out every `mimic` that cannot act, and notes it as a loss: the joint that it names is missing, has no
// axis to drive, or follows this one in the end. Call it after join_links().
void follow_joints(RobotModel& model);

// Null if there is none of this name.
const RobotJoint* find_joint(const RobotModel& model, const std::string& name);

}  // namespace visum::scene
