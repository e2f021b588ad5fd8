// The check of what an engine is handed, the same for every engine: a bad number never reaches a solver.
#pragma once

#include <string>

#include "server/dynamics/engine.h"

namespace visum::dynamics {

// The first fault in words, with the name of the body or joint; empty if there is none. Allocates only for a
// fault.
std::string find_input_fault(const world::WorldModel& model, const StepInput& input,
                             const world::WorldState& state);

}  // namespace visum::dynamics
