// Texts that say on which bodies a tick works, for people who wait for one.
#pragma once

#include <string>
#include <vector>

#include "server/world/world_model.h"

namespace visum::cycle {

// The first: the bodies that may collide. Then one for each engine: "engine 'impulse': base, link_1 (2
// bodies)". Each names a few bodies and counts all.
std::vector<std::string> work_texts_of(const world::WorldModel& model);

}  // namespace visum::cycle
