// Starts a program, with the steps before its first instruction that are easy to get wrong.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace visum::processes {

struct Spawned {
  pid_t pid;
  int out_fd, err_fd;  // what it writes; non-blocking
};

// Starts the program in a process group of its own, without our descriptors; the kernel kills it when we die.
// `in_fd` becomes its standard input, and stays the caller's; -1: it reads nothing. Throws
// std::runtime_error, which names the program, if it cannot be started.
Spawned spawn(const std::vector<std::string>& argv, int in_fd = -1);

struct PipeEnds {
  int read = -1, write = -1;
};

// Closed on exec at both ends. Throws std::runtime_error, which names the program.
PipeEnds make_pipe(const std::string& program);

}  // namespace visum::processes
