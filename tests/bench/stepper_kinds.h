// The engines that the physics benchmarks compare.
#pragma once

#include <vector>

#include "tests/bench/peers/stepper.h"

namespace visum::bench {

// Ours, then the other engines that this build has found, in the order of the table in stepper_kinds.cc.
const std::vector<StepperKind>& stepper_kinds();

}  // namespace visum::bench
