// The tree that joints make of the bodies. A body hangs on its first joint of a kind that carries
// (joint_kinds.h). A second such joint closes a loop. Pure functions.
#pragma once

#include <vector>

#include "server/world/world_model.h"

namespace visum::world {

// By BodyId: the joint that carries the body; invalid for bodies that are free or fixed.
std::vector<JointId> carrying_joints(const WorldModel& model);

}  // namespace visum::world
