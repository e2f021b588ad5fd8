// Says in words what a tick is doing.
#pragma once

#include <string>
#include <vector>

#include "hwparts/part.h"
#include "server/cycle/working.h"

namespace visum::gateway {

// "engine 'impulse': box, sphere (2 bodies)". Empty between ticks. `parts` and `work_texts`: those of the
// Simulation.
std::string working_text(const cycle::Working::Now& now, const std::vector<const hwparts::Part*>& parts,
                         const std::vector<std::string>& work_texts);

}  // namespace visum::gateway
