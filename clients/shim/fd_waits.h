// The one loop in which all waits for descriptors wait: look, wait for our turn, look again.
#pragma once

#include <algorithm>
#include <cerrno>
#include <cstdint>

#include "clients/shim/clocks.h"
#include "clients/shim/descriptors.h"
#include "clients/shim/timers.h"
#include "clients/shim/turns.h"

namespace visum::shim {

struct FdWait {
  const char* doing;
  std::int64_t deadline_ns = kNever;
  bool on_bus = false;
  bool on_session = false;
  std::uint64_t streams = 0;  // to buses, as bits
};

// A first look where no bytes are between the program and a bus: what the kernel has is all that can be
// there, wherever the descriptors lead. 0: nothing, or bytes are under way.
template <typename Look>
int look_at_settled(Look look) {
  if (!is_settled()) return 0;
  fire_timers();
  return look();
}

// The world stands until the server has answered, or the time-out is over by the wall clock.
template <typename Block>
int await_answer(const FdWait& wait, Block block) {
  const auto length = to_timespec(wait.deadline_ns - now_ns());
  return blocked(
      wait.doing, [&] { return block(wait.deadline_ns == kNever ? nullptr : &length); }, kHold);
}

// `look` asks the kernel without waiting: 0 means nothing yet, anything else is the result. `block` waits in
// the kernel for the given length (null: without end); it is called where the wait does not depend on
// simulated time. Returns the result of `look`, 0 at the deadline, or -1 with EINTR after a signal.
template <typename Look, typename Block>
int wait_for(const FdWait& wait, Look look, Block block) {
  for (std::uint32_t flags = kRecheck | (wait.on_bus ? kOnBus : 0u);; flags |= kAgain) {
    fire_timers();
    if (wait.on_bus) catch_up(wait.streams);
    if (const auto found = look(); found != 0) return found;
    if (wait.deadline_ns <= now_ns()) return 0;
    const auto next = std::min(wait.deadline_ns, next_timer_ns());
    if (wait.on_session) {
      // Nothing came within the time-out. Let the same time pass in the world; an answer may come by then.
      const int found = await_answer(wait, block);
      if (found != 0 || wait.deadline_ns == kNever) return found;
      if (park({wait.doing, wait.deadline_ns})) return look();
      errno = EINTR;
      return -1;
    }
    if (next == kNever && !wait.on_bus && !has_timers())
      return blocked(wait.doing, [&] { return block(nullptr); });
    if (park({wait.doing, next, flags})) continue;
    errno = EINTR;
    return -1;
  }
}

// Waits until `fd` can be read: 1, or 0 and -1 as above. Blocks in the kernel where simulated time plays no
// part in the wait.
int wait_readable(const char* doing, int fd, const Descriptor& what, std::int64_t deadline_ns);

}  // namespace visum::shim
