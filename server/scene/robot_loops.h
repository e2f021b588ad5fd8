// Loops of a model's joints.
#pragma once

#include "server/scene/robot_model.h"

namespace visum::scene {

// A joint whose file places it beyond its limits begins at the nearer one. That would pull a loop apart: in a
// loop such a joint begins where the file has it, and the limit gives way, which is noted as a loss. `joint`
// is `from` as the scene gets it, with its limits and initial position. Call it after join_links(), for
// joints that nobody has placed.
void keep_loop_closed(RobotModel& model, const RobotJoint& from, world::Joint& joint);

}  // namespace visum::scene
