// Finds a part's field bus among those that a server has.
#pragma once

#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::exec {

// Whose options the text of an error names: those of the visumd that somebody started, or `visum exec`'s own.
enum class Advice { kServersOptions, kOwnOptions };

// The text behind "KIND:" in the first bus of that kind: a path or a port. With an empty `part`: of the only
// part that has such a bus. Throws ExitError(kUsage), which says what there is instead and what to add.
std::string bus_of(const std::vector<protocol::PartBus>& buses, const std::string& part,
                   const std::string& kind, Advice advice);

}  // namespace visum::exec
