// Writes what a Profile measured, for `visumd --profile`. Main thread.
#pragma once

#include <string>

#include "protocol/config/profile.h"

namespace visum::programs {

// The first line holds the sums, and opens the list of events. Where spans are kept, the last line says what
// writing them took, which is no part of the run. `visum run` reads both. The file as a whole is a trace in
// Chrome's JSON, which Perfetto opens. Throws std::runtime_error if it cannot be written.
void write_profile(const config::Profile& profile, const std::string& file);

}  // namespace visum::programs
