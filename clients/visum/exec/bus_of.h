// Where a server's parts have their field buses.
#pragma once

#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::exec {

// What stands behind "KIND:" in the first bus of that kind: a path or a port. `part` empty: of the only part
// that has one. Throws ExitError(kUsage) that says what there is instead.
std::string bus_of(const std::vector<protocol::PartBus>& buses, const std::string& part,
                   const std::string& kind);

}  // namespace visum::exec
