// Reads actuators, equality constraints and keyframes of an MJCF file, and notes what is not read. Errors and
// losses go to `reading`.
#pragma once

#include "server/scene/mjcf/bodies.h"

namespace visum::scene::mjcf {

// Names the joints that have an actuator, with its limits of effort and speed.
void read_actuators(Reading& reading);

// <connect> and <weld> become joints that close loops.
void read_equalities(Reading& reading, const std::vector<BodyEntry>& bodies);

// Lets the bodies start as the keyframe "home" says, if there is one.
void read_home(Reading& reading, std::vector<BodyEntry>& bodies);

void note_unread(Reading& reading);

}  // namespace visum::scene::mjcf
