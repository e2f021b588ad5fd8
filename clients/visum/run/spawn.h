// fork and exec with what must be right between the two.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace visum::run {

struct Spawned {
  pid_t pid;
  int out_fd, err_fd;  // what it writes; non-blocking
};

// In a process group of its own, without our descriptors, killed when we die. Throws std::runtime_error that
// names the program where it cannot be started.
Spawned spawn(const std::vector<std::string>& argv);

}  // namespace visum::run
