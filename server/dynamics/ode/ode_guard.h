// ODE ends the process when it meets something that it cannot compute. Here its handlers throw instead, and
// its messages are counted. The handlers belong to the process, the count to the thread.
#pragma once

#include <cstdint>
#include <stdexcept>

namespace visum::dynamics::ode {

// Thrown where ODE would have aborted. The dWorld in which it happened is lost.
class OdeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Initialises ODE for the process and this thread, and sets the handlers. Cheap to call again.
// Call it before any function of ODE. Throws as load_ode() does.
void ensure_ode();

// How many messages ODE has written on this thread without giving up (for example an LCP that it solved only
// in part).
std::uint64_t ode_messages();

}  // namespace visum::dynamics::ode
