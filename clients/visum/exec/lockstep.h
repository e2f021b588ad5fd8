// Runs a program in lockstep with a world, from its start to its end.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "clients/visum/exec/device_place.h"
#include "protocol/client.h"

namespace visum::exec {

struct LockstepPlan {
  std::vector<std::string> command;
  std::vector<Placement> placements;
  std::uint16_t session_port = 0;  // the server's own
  protocol::Join join;
  std::int64_t period_ns = 0;  // between the program's wake-ups, in whole ticks; 0: one tick
  std::chrono::steady_clock::time_point give_up = std::chrono::steady_clock::time_point::max();
};

struct LockstepEnd {
  int status = 0;  // in the form of waitpid()
  protocol::ServerStatus world;
  std::string invalid;  // why the run was not in step with the world; empty: it was
  bool started = true;  // false: the program could not be run at all, as a message on stderr has said
};

// Runs it under the time shim (grade L2). `connection` becomes a member of the lockstep. Throws ExitError:
// kUsage (the server's clock is another), kTimedOut, kLost (the world), kFailed. The program and all that it
// started have ended then.
LockstepEnd run_in_lockstep(protocol::Connection connection, const LockstepPlan& plan);
// The same in real time, behind the gate of `plan.join` (grade L1).
LockstepEnd run_gated(protocol::Connection connection, const LockstepPlan& plan);

}  // namespace visum::exec
