// The two parts of a mirror: the arm as the controller knows it, and the divergence of the two arms behind
// it.
#pragma once

#include <memory>
#include <string>

#include "hwparts/part.h"
#include "server/mirror/mirror.h"

namespace visum::mirror {

// A part with the ports, parameters and blackboard of the arms. The mirror must outlive the parts.
std::unique_ptr<hwparts::Part> make_mirrored_arm(Mirror& mirror);

// A part that only tells. Sensor outputs: "Divergence of Actual Angle 1" ... (the shadow's minus the
// primary's), "Largest Angle Divergence" [rad], "Largest Position Divergence" [m], "Primary" (1, 2),
// "Connected 1", "Connected 2", "Divergence Fault", "Refusals 1", "Refusals 2" (commands that the arms
// refused), "World Of" (the arm whose world is shown; 0: there is none). Parameters: "Primary", "Force
// Primary", and the limits. Blackboard "Fault": why the last fault was raised.
std::unique_ptr<hwparts::Part> make_divergence(Mirror& mirror, const std::string& name);

}  // namespace visum::mirror
