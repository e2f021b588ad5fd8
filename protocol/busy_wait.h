// A wait that looks again and again for a moment before it sleeps. Where a processor has gone idle, waking it
// takes tens of microseconds, more than a controller needs for its answer in lockstep. Looking helps only if
// the other side runs meanwhile on another processor. So a wait sleeps at once for a while after it has
// looked in vain, and for longer where other threads want the processor; never does it look with one
// processor, or under the time shim, whose clock stands while one looks.
//
// Used on one thread at a time. Allocates nothing.
#pragma once

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace visum::protocol {

class BusyWait {
 public:
  BusyWait();
  // Calls look() until it returns true, for at most `at_most` and a tenth of a millisecond. False: sleep now.
  template <typename Look>
  bool find(Look&& look, std::chrono::nanoseconds at_most) {
    if (!may_look()) return false;
    const auto begin = Clock::now(), end = begin + std::min<std::chrono::nanoseconds>(at_most, kLongest);
    for (auto last = begin;;) {
      if (look()) return found(Clock::now() - last);
      ::sched_yield();
      const auto now = Clock::now();
      if (now >= end || now - last > kPushedOut) return missed(now - last);
      last = now;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::microseconds kLongest{100};
  static constexpr std::chrono::microseconds kPushedOut{25};  // between two looks: another thread ran here

  bool may_look();
  bool found(Clock::duration since_last);
  bool missed(Clock::duration since_last);
  void doubt(int more);

  bool helps_ = true;
  int doubt_ = 0;           // waits of late in which looking did not help, less those in which it did
  std::uint32_t skip_ = 0;  // so many waits sleep at once
};

}  // namespace visum::protocol
