// Reads from /proc how a program's threads fare. One thread uses it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <string>

namespace visum::exec {

struct ThreadState {
  char letter = 'X';        // from /proc: R, S, D, T, t, Z; X where it is gone
  pid_t parent = 0;         // of the thread's process
  std::uint64_t ticks = 0;  // processor time used so far, in the kernel's unit
  bool gone() const { return letter == 'X' || letter == 'Z'; }
  bool sleeps() const { return letter == 'S'; }
};

enum class KernelWait {
  kInput,     // until there is something to read; without a time-out
  kChild,     // until a child has ended
  kHostTime,  // until a time of the host's, or with a time-out by it
  kOther,
};

// Keeps the files in /proc open, so that asking again costs one system call.
class Threads {
 public:
  Threads() = default;
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  ThreadState state(pid_t process, pid_t thread);
  // The call of the kernel that a thread sleeps in. kOther also where the kernel does not let us look.
  static KernelWait wait_of(pid_t process, pid_t thread);
  void forget(pid_t thread);

 private:
  std::map<pid_t, int> files_;  // by thread
};

// "controller", from /proc; "?" where it is gone.
std::string process_name(pid_t process);

}  // namespace visum::exec
