#include "server/dynamics/ode/ode_library.h"

#include "protocol/config/shared_library.h"

namespace visum::dynamics::ode {

#define VISUM_ODE_POINTER(name) decltype(&::name) name = nullptr;
VISUM_ODE_FUNCTIONS(VISUM_ODE_POINTER)
#undef VISUM_ODE_POINTER

void load_ode() {
  const config::SharedLibrary library(VISUM_ODE_LIBRARY, "the engine ODE", "libode8");
#define VISUM_ODE_FIND(name) library.find(#name, name);
  VISUM_ODE_FUNCTIONS(VISUM_ODE_FIND)
#undef VISUM_ODE_FIND
}

}  // namespace visum::dynamics::ode
