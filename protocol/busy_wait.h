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
  // Calls look() until it returns true, for at most `at_most` and 0.4 ms, and yield() in between. False:
  // sleep now.
  template <typename Look, typename Yield = int (*)()>
  bool find(Look&& look, std::chrono::nanoseconds at_most, Yield&& yield = ::sched_yield) {
    if (!may_look()) return false;
    const auto end = Clock::now() + std::min<std::chrono::nanoseconds>(at_most, kLongest);
    for (;;) {
      if (look()) return found(false);
      const auto before = Clock::now();
      yield();
      const auto now = Clock::now();
      if (now - before > kPushedOut) return look() ? found(true) : missed(true);
      if (now >= end) return missed(false);
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::microseconds kLongest{400};    // ten ticks of an arm that carries a box
  static constexpr std::chrono::microseconds kPushedOut{100};  // to yield: another thread ran here

  bool may_look();
  bool found(bool pushed_out);
  bool missed(bool pushed_out);
  void doubt(int more);

  bool helps_ = true;
  int doubt_ = 0;           // waits of late in which looking did not help, less those in which it did
  std::uint32_t skip_ = 0;  // so many waits sleep at once
};

}  // namespace visum::protocol
