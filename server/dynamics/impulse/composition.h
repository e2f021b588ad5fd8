// Steps of higher order: a symmetric step of order 2, repeated with lengths that add up to one and cancel the
// next terms of the error. Suzuki, Phys. Lett. A 146 (1990) for order 4; Yoshida, Phys. Lett. A 150 (1990),
// solution A, for order 6.
#pragma once

#include <span>

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

// The lengths of the steps that make up a tick of length h, as shares of h. It is one step wherever a step
// back in time would not undo what happens: a contact, a drive, friction, a damper, a stop within reach, or a
// pose near which a loop could leave on another branch. The mechanisms must be factored.
std::span<const double> stages(const Plant& plant, double h);

}  // namespace visum::dynamics::impulse
