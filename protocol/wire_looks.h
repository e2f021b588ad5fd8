// Translates the parts of a world's description that say how it looks: materials, lights, viewpoints, panels.
// Used by wire_world.cc.
#pragma once

#include "protocol/wire.h"

namespace visum::protocol::wire {

void put_looks(const WorldDescription& from, v1::WorldDescription& to);
void take_looks(const v1::WorldDescription& from, WorldDescription& to);

}  // namespace visum::protocol::wire
