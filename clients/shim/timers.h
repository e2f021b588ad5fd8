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
// The program closes it.
void forget_timer(int fd);
// In a new process: timers stay with the one that made them.
void forget_all_timers();

}  // namespace visum::shim
