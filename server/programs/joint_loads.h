// The load behind each joint of a model: inertia about its axis, and the effort that gravity asks of it.
// Pure functions.
#pragma once

#include <vector>

#include "server/world/world_model.h"

namespace visum::programs {

struct JointLoad {
  double inertia = 0.0;  // kg·m² or kg, of all that the joint moves, about or along its axis
  double gravity = 0.0;  // N·m or N, to hold it still
};

// The worst of a few poses, for each of `joints` (hinges, sliders and screws): the start, all joints at 0,
// all in the middle, and each of them a quarter turn (or a quarter of its way) to either side with the others
// at 0. What the joint moves counts as one rigid body, and what carries it as fixed. So an arm's load is that
// of its own links; a leg that stands carries more.
std::vector<JointLoad> worst_loads(const world::WorldModel& model, const std::vector<world::JointId>& joints);

}  // namespace visum::programs
