// A thread's turn: it runs until it waits, and then waits until the scheduler gives it its turn again. Any
// thread may call these functions; "we" is the calling thread.
#pragma once

#include <cerrno>
#include <cstdint>

#include "clients/shim/channel.h"

namespace visum::shim {

// Null where the program was started without a scheduler: then the shim passes everything through.
Shared* shared();
inline bool active() {
  return shared() != nullptr;
}
Slot& mine();

std::int64_t now_ns();  // simulated

struct Wait {
  const char* doing;  // at most kNameSize - 1 characters
  std::int64_t deadline_ns = kNever;
  std::uint32_t flags = 0;
  std::uint64_t key = 0;
};
// Waits for our turn. False: a signal was handled meanwhile.
bool park(const Wait& wait);
// park() in two steps, for a thread that must count as waiting before it releases a lock: announce(), release
// the lock, park_announced().
void announce(const Wait& wait);
bool park_announced();

// Wrap a call that may block in the kernel, on something that simulated time does not drive.
void enter_blocked(const char* doing, std::uint32_t flags, std::uint64_t key = 0);
void leave_blocked();
template <typename Call>
auto blocked(const char* doing, Call call, std::uint32_t flags = 0, std::uint64_t key = 0) {
  enter_blocked(doing, flags, key);
  const auto result = call();
  const int error = errno;
  leave_blocked();
  errno = error;
  return result;
}

// Counts a look at a clock or a descriptor that did not wait. A thread that does nothing else makes time pass
// by it.
void note_look(const char* doing, bool on_bus = false);
void note_progress();  // the thread did something: the count of looks begins again
// True if the count is so low that it hardly matters whether it begins again.
bool has_looked_little();
// Counts a request over a bus or a session. A thread that asks again and again makes time pass by it.
void note_request();

// Reserves a slot for a thread or process that is about to start; null where all are taken. The new thread
// calls take_slot(); drop_slot() frees the slot where the start failed.
Slot* keep_slot(std::int32_t pid, std::int32_t parent);
void take_slot(Slot& slot);
void drop_slot(Slot& slot);
// The same where the process came and went without taking its slot: it never loaded the shim, and the run is
// not in step with it.
void give_up_slot(Slot& slot);
// Waits for the first turn.
void begin_turn();
// The last instructions of the thread, or of the whole process, follow.
void leave();
void leave_process();

void say(const char* format, ...) __attribute__((format(printf, 1, 2)));  // on stderr

}  // namespace visum::shim
