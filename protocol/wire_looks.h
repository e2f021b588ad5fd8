// How a scene wants to be seen, as part of its description (wire_world.cc).
#pragma once

#include "protocol/wire.h"

namespace visum::protocol::wire {

void put_looks(const WorldDescription& from, v1::WorldDescription& to);
void take_looks(const v1::WorldDescription& from, WorldDescription& to);

}  // namespace visum::protocol::wire
