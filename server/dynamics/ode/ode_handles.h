// Owning handles for ODE's objects.
#pragma once

#include <memory>
#include <type_traits>

#include "server/dynamics/ode/ode_library.h"

namespace visum::dynamics::ode {

struct Destroy {
  void operator()(dWorldID world) const { dWorldDestroy(world); }
  void operator()(dJointGroupID group) const { dJointGroupDestroy(group); }
};

using WorldHandle = std::unique_ptr<std::remove_pointer_t<dWorldID>, Destroy>;
using GroupHandle = std::unique_ptr<std::remove_pointer_t<dJointGroupID>, Destroy>;

}  // namespace visum::dynamics::ode
