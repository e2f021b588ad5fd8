// A program started beside us, in our process group and with our input and output: with a part's devices in
// their places, and our signals handed on.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "clients/visum/exec/device_place.h"

namespace visum::exec {

inline constexpr int kNotExecutable = 126, kNotFound = 127;  // as shells and env(1) have it

// Becomes the program. Returns only where that fails: the exit code, after a word on stderr.
int become(std::vector<std::string> command);

// Starts it. It dies when we die. Where it cannot be started it ends at once, with 125, 126 or 127, after a
// word on stderr. Throws ExitError(kFailed) where there is no process left.
pid_t launch(const std::vector<std::string>& command, const std::vector<Placement>& placements);

// Once it has ended: whether the program of launch() came to run at all.
bool was_started();

// Until it has ended: its status, as waitpid() has it. Throws ExitError(kTimedOut) at `give_up`, and what
// `on_readable` throws, which is called when `fd` is readable; both after killing it.
int await_end(pid_t program, std::chrono::steady_clock::time_point give_up, int fd = -1,
              const std::function<void()>& on_readable = {});

// Its exit code as `visum exec` gives it on: its own, or kLost, with a word on stderr, where a signal ended
// it.
int exit_code_of(int status, const std::string& program);

}  // namespace visum::exec
