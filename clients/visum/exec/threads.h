// What the kernel says of a program's threads.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <string>

namespace visum::exec {

struct ThreadState {
  char letter = 'X';        // of /proc: R, S, D, T, t, Z; X: gone
  pid_t parent = 0;         // of its process
  std::uint64_t ticks = 0;  // processor time used so far, in the kernel's unit
  bool gone() const { return letter == 'X' || letter == 'Z'; }
  bool sleeps() const { return letter == 'S'; }
};

// Keeps the files open: asking again costs one system call.
class Threads {
 public:
  Threads() = default;
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  ThreadState state(pid_t process, pid_t thread);
  // Whether the thread sleeps in a call of the kernel that ends by a time of the host's.
  static bool waits_by_host_time(pid_t process, pid_t thread);
  void forget(pid_t thread);

 private:
  std::map<pid_t, int> files_;  // by thread
};

// "controller", from /proc; "?" where it is gone.
std::string process_name(pid_t process);

}  // namespace visum::exec
