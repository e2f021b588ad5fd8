// Mechanical stops by ODE's own limit row, for joints that turn more than once too.
#pragma once

#include <ode/ode.h>

#include "server/world/world_model.h"

namespace visum::dynamics::ode {

// Sets what does not change. `joint` is a hinge or a slider.
void prepare_stops(dJointID joint, const world::Joint& model, const world::EngineSetting& setting);

// Before each step, with the bodies in place. `position` tells the turn.
void set_stops(dJointID joint, const world::Joint& model, double position);

}  // namespace visum::dynamics::ode
