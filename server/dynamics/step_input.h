// Checks what an engine is given. All engines share it, so a bad number never reaches a solver.
#pragma once

#include <string>

#include "server/dynamics/engine.h"

namespace visum::dynamics {

// Returns the text of the first fault, with the name of the body or joint; empty if there is none. Allocates
// only for a fault.
std::string find_input_fault(const world::WorldModel& model, const StepInput& input,
                             const world::WorldState& state);

}  // namespace visum::dynamics
