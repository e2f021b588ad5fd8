// The tree that joints make of bodies. A body's first joint that carries (joint_kinds.h) carries it;
// a second one closes a loop.
#pragma once

#include <vector>

#include "server/world/world_model.h"

namespace visum::world {

// By BodyId: the joint that carries the body; invalid for what stands free or is fixed.
std::vector<JointId> carrying_joints(const WorldModel& model);

}  // namespace visum::world
