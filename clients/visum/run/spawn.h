// fork and exec, with the steps between the two that are easy to get wrong.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace visum::run {

struct Spawned {
  pid_t pid;
  int out_fd, err_fd;  // what it writes; non-blocking
};

// Starts the program in a process group of its own, without our descriptors; the kernel kills it when we die.
// Throws std::runtime_error, which names the program, if it cannot be started.
Spawned spawn(const std::vector<std::string>& argv);

}  // namespace visum::run
