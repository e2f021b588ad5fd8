// Starts of processes by system calls, with a slot reserved for the child: the world waits for the child from
// its first moment, and the run is not valid where it never takes its slot.
#pragma once

#include <errno.h>
#include <linux/sched.h>
#include <unistd.h>

#include "clients/shim/timers.h"
#include "clients/shim/turns.h"

namespace visum::shim {

// In the child: the slot is its own from now on.
inline void begin_child(Slot& slot) {
  forget_all_timers();
  take_slot(slot);
}

// `fork` is fork() or a system call like it: it returns 0 in a child that has a copy of our memory.
template <typename Fork>
auto fork_by(Fork fork) -> decltype(fork()) {
  auto* slot = keep_slot(0, ::getpid());
  if (!slot) {
    errno = EAGAIN;
    return -1;
  }
  const auto child = fork();
  if (child == 0)
    begin_child(*slot);
  else if (child < 0)
    drop_slot(*slot);
  return child;
}

// `call` starts a process, which takes the slot once it loads the shim. It returns the process' id, or a
// negative number.
template <typename Call>
auto spawn_by(Call call) -> decltype(call()) {
  auto* slot = keep_slot(0, ::getpid());
  const auto child = call();
  if (!slot) return child;
  if (child < 0)
    drop_slot(*slot);
  else if (child > 0 && slot->state == State::kStarting)
    slot->pid = static_cast<std::int32_t>(child);
  return child;
}

// True for flags of clone() with which the child may as well have a copy of our memory: it asks for one, or
// we wait until it has become another program. A process in a namespace of its own does not know its id here.
inline bool is_like_fork(long flags) {
  if ((flags & (CLONE_THREAD | CLONE_NEWPID)) != 0) return false;
  return (flags & CLONE_VM) == 0 || (flags & CLONE_VFORK) != 0;
}
inline long as_fork(long flags) {
  return flags & ~static_cast<long>(CLONE_VM | CLONE_VFORK | CLONE_SIGHAND);
}

}  // namespace visum::shim
