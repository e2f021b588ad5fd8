// Starts a program beside us, in our process group and with our input and output. It finds a part's devices
// in their places, and gets the signals that are sent to us.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "clients/visum/exec/device_place.h"

namespace visum::exec {

inline constexpr int kNotExecutable = 126, kNotFound = 127;  // as shells and env(1) have it

// Becomes the program. Returns only where that fails: the exit code, after a message on stderr.
int become(std::vector<std::string> command);

// Starts it. It dies when we die. Where it cannot be started the child ends at once with 125, 126 or 127,
// after a message on stderr. Throws ExitError(kFailed) where the system has no process left.
pid_t launch(const std::vector<std::string>& command, const std::vector<Placement>& placements);

// Once it has ended: whether the program of launch() came to run at all.
bool was_started();

// Waits for its end and returns its status, in the form of waitpid(). Calls `on_readable` whenever `fd` is
// readable. Throws ExitError(kTimedOut) at `give_up`, and anything that `on_readable` throws; both after
// killing the program.
int await_end(pid_t program, std::chrono::steady_clock::time_point give_up, int fd = -1,
              const std::function<void()>& on_readable = {});

// The exit code that `visum exec` returns: the program's own or, after a message on stderr, kLost where a
// signal ended it.
int exit_code_of(int status, const std::string& program);

}  // namespace visum::exec
