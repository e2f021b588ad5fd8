// ODE ends the process when it meets what it cannot compute. Here its handlers throw instead, and its
// messages are counted. The handlers are the process's, the count is the thread's.
#pragma once

#include <cstdint>
#include <stdexcept>

namespace visum::dynamics::ode {

// What ODE would have aborted for. The dWorld in which it happened is lost.
class OdeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Initialises ODE for the process and this thread, and sets the handlers. Cheap to call again.
void ensure_ode();

// How often ODE has complained on this thread and gone on (an LCP that it solved only in part).
std::uint64_t ode_messages();

}  // namespace visum::dynamics::ode
