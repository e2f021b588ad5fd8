// Shared by the server programs, around their daemon: exit codes, the log, signals, the line that says
// "ready". Main thread only, but for the signal handler inside.
#pragma once

#include <functional>
#include <string>

#include "server/gateway/daemon.h"

namespace visum::programs {

// The exit codes of the server programs.
enum Exit {
  kPassed = 0,
  kFailed = 1,
  kUsage = 2,
  kConfigWrong = 3,
  kDiffers = 5,
  kTimedOut = 124,
  kInterrupted = 130
};

// The log goes to stderr as "NAME: level: text". Verbosity: 0 errors, 1 warnings, 2 news, 3 details.
void set_up_log(const std::string& name, int verbosity);
void set_verbosity(int verbosity);

// Calls run() and returns its exit code. If it throws, the error goes to the log: kConfigWrong for a
// ConfigError, else kUsage.
int exit_code_of(const std::function<int()>& run);

// Says that the daemon is ready, then runs it until it ends or SIGINT or SIGTERM ends it. Returns that
// signal, or 0. "Ready" goes to stdout as one line of JSON if `json`, else to the log, and to systemd in both
// cases.
int run_until_signal(gateway::Daemon& daemon, const cycle::Simulation& simulation,
                     const gateway::DaemonOptions& options, bool json);

}  // namespace visum::programs
