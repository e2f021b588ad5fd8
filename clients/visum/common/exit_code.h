// The exit codes of `visum`, the same for all verbs, and the exception that carries one.
#pragma once

#include <stdexcept>
#include <string>

namespace visum::cli {

enum ExitCode : int {
  kDone = 0,
  kFailed = 1,         // a check failed, or the server refused
  kUsage = 2,          // wrong options, unknown names, values that no port takes
  kBadConfig = 3,      // the scene or scenario is wrong
  kLost = 4,           // the connection or a controller was lost, or timed out in lockstep
  kDiffers = 5,        // two recordings or campaigns are not the same
  kInvalid = 6,        // the run's claim could not be established: host too slow, program not in step, ...
  kTimedOut = 124,     // the wall time that was allowed is over
  kExecFailed = 125,   // `visum exec` itself failed
  kInterrupted = 130,  // Ctrl-C
};

// Ends the program with this code and, on stderr, this text.
class ExitError : public std::runtime_error {
 public:
  ExitError(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace visum::cli
