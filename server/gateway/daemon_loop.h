// The loop of the daemon: which thread ticks, which one serves the sessions, and who waits for whom.
#pragma once

#include <atomic>
#include <memory>
#include <utility>

#include "server/gateway/daemon_doors.h"

namespace visum::gateway {

// Owned by the Daemon. Made and run on one thread.
class DaemonLoop {
 public:
  virtual ~DaemonLoop() = default;
  // Until a stop, a client's Shutdown, or the last of the iterations. Passes on what a tick throws.
  virtual void run() = 0;

  virtual DaemonDoors& doors() = 0;
};

// Clock realtime: the caller's thread ticks, and the sessions have a thread of their own.
std::unique_ptr<DaemonLoop> make_realtime_loop(cycle::Simulation& simulation, const DaemonOptions& options,
                                               std::atomic<bool>& stop);
// Clocks lockstep and free: the caller's thread does both, one after the other.
std::unique_ptr<DaemonLoop> make_inline_loop(cycle::Simulation& simulation, const DaemonOptions& options,
                                             std::atomic<bool>& stop);

}  // namespace visum::gateway
