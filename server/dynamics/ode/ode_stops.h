// Mechanical stops by ODE's own limit row, also for joints that turn more than once.
#pragma once

#include "server/dynamics/ode/ode_library.h"
#include "server/world/world_model.h"

namespace visum::dynamics::ode {

// Sets the parameters that do not change. `joint` is a hinge or a slider.
void prepare_stops(dJointID joint, const world::Joint& model, const world::EngineSetting& setting);

// To be called before each step, with the bodies in place. `position` says in which turn the joint is.
void set_stops(dJointID joint, const world::Joint& model, double position);

}  // namespace visum::dynamics::ode
