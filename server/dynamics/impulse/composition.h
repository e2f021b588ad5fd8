// Steps of higher order: a symmetric step of order 2, composed of itself with lengths that add up to one and
// cancel the error's next terms. Suzuki, Phys. Lett. A 146 (1990) for order 4; Yoshida, Phys. Lett. A 150
// (1990), solution A, for order 6.
#pragma once

#include <span>

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

// The lengths of the steps of a tick of length h, as shares of it. One step where something happens that no
// step back undoes: a contact, a drive, friction, a stop within reach, a damper, or where a loop could leave
// on another branch. Mechanisms are factored.
std::span<const double> stages(const Plant& plant, double h);

}  // namespace visum::dynamics::impulse
