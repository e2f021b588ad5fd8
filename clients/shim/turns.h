// A thread's turn: it runs until it waits, and waits until whoever drives the time (the scheduler) gives it
// its turn again. Any thread; what a function says of "us" is the calling thread.
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
// The same in pieces, for who must be found waiting before he waits: announce(), let go of what others need,
// then park_announced().
void announce(const Wait& wait);
bool park_announced();

// Around a call that may wait for what is not ours to drive.
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

// We looked at something and did not wait: a clock, a descriptor. Who does only that makes time go on by it.
void note_look(const char* doing);
void note_progress();  // but here we did something: it is no mere looking
// The world was asked something, over a bus or a session. Who asks and asks makes time go on by it.
void note_request();

// A slot for a thread or process that is about to be; null: there is no room. take_slot() is for itself to
// call, drop_slot() where nothing came of it.
Slot* keep_slot(std::int32_t pid, std::int32_t parent);
void take_slot(Slot& slot);
void drop_slot(Slot& slot);
// The same where the process came and went without taking its slot: it never loaded the shim, and the run is
// not in step with it.
void give_up_slot(Slot& slot);
// Waits for the first turn.
void begin_turn();
// Our last instructions follow; of the thread, or of the whole process.
void leave();
void leave_process();

void say(const char* format, ...) __attribute__((format(printf, 1, 2)));  // on stderr

}  // namespace visum::shim
