// Gives a world an input of a recording. What the input says is not believed: names, numbers and places are
// checked as at the edge of a running daemon.
#pragma once

#include <string>

#include "protocol/recording/input.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

// Why not; empty: done.
std::string apply(Simulation& simulation, const recording::Input& input);

}  // namespace visum::cycle
