// A hardware part whose kind comes from a plug-in. Its ports are the plug-in's, then `Node State` (0: it
// works, 1: it is in fault). The blackboard `fault` says why. A part in fault lets go of its joints and keeps
// its outputs. The simulation owns it; it lives on the tick's thread.
#pragma once

#include <memory>

#include "hwparts/part.h"
#include "protocol/plugin/plugin.h"

namespace visum::plugged {

// Throws ConfigError for an error in the part's entry.
std::unique_ptr<hwparts::Part> make_part(const plugin::PartKind& kind, const hwparts::PartContext& context);

}  // namespace visum::plugged
