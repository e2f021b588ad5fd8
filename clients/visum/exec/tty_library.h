// Puts clients/ttylib into the environment of the program that this process becomes. That library keeps the
// program's own output on placed devices from being discarded.
#pragma once

#include <vector>

#include "clients/visum/exec/device_place.h"

namespace visum::exec {

// Call it before place_devices(). Throws ExitError where the library is missing.
void load_tty_library(const std::vector<Placement>& placements);

}  // namespace visum::exec
