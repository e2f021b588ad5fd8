// Robots written with OpenHRP's prototypes, which Choreonoid reads, too: a Humanoid of Joints, each with
// Segments that hold mass and shapes. They extend the prototypes of H-Anim 1.1 by jointType, jointAxis and
// the like. A Joint becomes a body and a joint of its name.
#pragma once

#include "server/scene/convert/x3d_shapes.h"

namespace visum::scene {

inline constexpr std::size_t kMaxX3dLinks = 256;  // of one robot

// True for an instance of a prototype Humanoid with at least one Joint.
bool is_x3d_robot(const X3dNode& node);

// Adds the links and joints of a robot, and a part of the kind `ideal_joints` that drives them. z is up. Its
// links do not collide with each other. Throws ConfigError.
void read_x3d_robot(Draft& draft, X3dShapes& shapes, const X3dNode& humanoid, const X3dFrame& frame);

}  // namespace visum::scene
