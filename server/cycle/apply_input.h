// Gives a world an input of a recording. The file may be damaged or forged, so names, numbers and places are
// checked here as the gateway checks those of a client. Tick's thread.
#pragma once

#include "protocol/recording/input.h"
#include "server/cycle/outcome.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

// Refuses where this world does not take the input that the recorded one took.
Outcome apply(Simulation& simulation, const recording::Input& input);

}  // namespace visum::cycle
