// Timers of this process: timerfd, as descriptors that count; setitimer and alarm, as entries that the
// scheduler looks at.
#pragma once

#include <cstdint>

namespace visum::shim {

// Makes the descriptors of the timers that are due readable.
void fire_timers();
// When the next is due; kNever: none.
std::int64_t next_timer_ns();
bool has_timers();  // armed or not
// Call it when the program closes the descriptor.
void forget_timer(int fd);
// Call it in a new process: timers stay with the process that made them.
void forget_all_timers();

}  // namespace visum::shim
