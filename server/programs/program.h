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

// The log goes to stderr as "NAME: level: text", by a thread of its own (log_writer.h): call end_log() before
// the program ends. Verbosity: 0 errors, 1 warnings, 2 news, 3 details.
void set_up_log(const std::string& name, int verbosity);
void set_verbosity(int verbosity);
// Waits until the log is written, a second at most: perhaps nobody reads it.
void end_log();

// Calls run() and returns its exit code. If it throws, the error goes to the log: kConfigWrong for a
// ConfigError, else kUsage.
int exit_code_of(const std::function<int()>& run);

// Ends the process without destructors, since one of its threads will not come back.
[[noreturn]] void end_at_once(Exit code);

// Says that the daemon is ready, then runs it until it ends or SIGINT, SIGTERM or SIGHUP ends it. Returns
// that signal, or 0. "Ready" goes to stdout as one line of JSON if `json`, else to the log, and to systemd in
// both cases.
int run_until_signal(gateway::Daemon& daemon, const cycle::Simulation& simulation,
                     const gateway::DaemonOptions& options, bool json);

}  // namespace visum::programs
