// A hardware part whose kind comes from a plug-in. Its ports are the plug-in's, then `Node State`: 0 it
// works, 1 it is in fault, why is on the blackboard `fault`. What fails lets go of its joints and keeps its
// outputs.
#pragma once

#include <memory>

#include "hwparts/part.h"
#include "protocol/plugin/plugin.h"

namespace visum::plugged {

// Throws ConfigError at what is wrong in the part's entry.
std::unique_ptr<hwparts::Part> make_part(const plugin::PartKind& kind, const hwparts::PartContext& context);

}  // namespace visum::plugged
