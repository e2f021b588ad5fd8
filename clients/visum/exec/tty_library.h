// The library that keeps what a program has written to placed devices (clients/ttylib), in the environment of
// what this process becomes.
#pragma once

#include <vector>

#include "clients/visum/exec/device_place.h"

namespace visum::exec {

// Before place_devices(). Throws ExitError where the library is not where it was installed.
void load_tty_library(const std::vector<Placement>& placements);

}  // namespace visum::exec
