// What the server programs have in common around their daemon: log, signals, the ready line.
#pragma once

#include <functional>
#include <string>

#include "server/gateway/daemon.h"

namespace visum::programs {

// Exit codes.
enum Exit {
  kPassed = 0,
  kFailed = 1,
  kUsage = 2,
  kConfigWrong = 3,
  kDiffers = 5,
  kTimedOut = 124,
  kInterrupted = 130
};

// To stderr, as "NAME: level: text"; 0 errors, 1 warnings, 2 news, 3 details.
void set_up_log(const std::string& name, int verbosity);
void set_verbosity(int verbosity);

// What `run` returns; where it throws, the exit code of that, once the error is in the log.
int exit_code_of(const std::function<int()>& run);

// Runs the daemon until it ends, or until SIGINT or SIGTERM end it; returns the signal, 0: none. Says that it
// is ready before: on stdout as one line of JSON where wanted, else in the log, and to systemd.
int run_until_signal(gateway::Daemon& daemon, const cycle::Simulation& simulation,
                     const gateway::DaemonOptions& options, bool json);

}  // namespace visum::programs
