// Notices that the sessions' thread did not run for a while: the process was stopped, or starved.
#pragma once

#include <chrono>

namespace visum::gateway {

// Lives on the sessions' thread, in clock realtime only. The kernel does not say when it received a byte of a
// TCP connection. But requests that are read right after a gap have waited in it, for up to its length; they
// count as that old until everything that was there at its end has been read.
class Holdup {
 public:
  using Clock = std::chrono::steady_clock;

  // `limit` 0: no gap counts. It must be well above the time between two looks of an idle server.
  void set_limit(std::chrono::milliseconds limit) { limit_ = limit; }
  // To be called at each request and each time that the server's loop comes round.
  void look(Clock::time_point now) {
    const auto gap = last_ == Clock::time_point{} ? Clock::duration::zero() : now - last_;
    last_ = now;
    if (limit_.count() > 0 && gap > limit_) length_ = gap;
  }
  // Everything that had waited has been read.
  void end() { length_ = {}; }
  // How old a request may be that is read now; 0: it is new.
  Clock::duration age() const { return length_; }

 private:
  std::chrono::milliseconds limit_{0};
  Clock::time_point last_{};
  Clock::duration length_{};
};

}  // namespace visum::gateway
