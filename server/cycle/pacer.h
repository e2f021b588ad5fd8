// Paces a realtime world to the wall clock: says when the next tick is due, and counts ticks that come too
// late. It does not sleep; the loop does. Lives on the tick's thread, owned by TickSide; any thread may read
// the counters.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "server/cycle/lateness.h"

namespace visum::cycle {

class Pacer {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Pacer(std::int64_t tick_ns) : tick_ns_(tick_ns) {}

  // Simulated seconds per second of wall time, > 0. The time that is left until the next tick is scaled, too.
  void set_speed(double factor, Clock::time_point now);
  double speed() const { return speed_; }

  // Starts the time anew, after a pause or a reset: the next tick is a period away, and none was missed.
  void restart(Clock::time_point now) { due_ = now + period(); }

  Clock::time_point due() const { return due_; }

  // A tick begins at `now`. If that is more than a period late, it counts as an overrun. The missed ticks are
  // dropped, so that no burst of ticks follows.
  void begin_tick(Clock::time_point now);

  // The time that was dropped with them. On the tick's thread only.
  std::chrono::nanoseconds lost() const { return lost_; }
  std::uint64_t overruns() const { return overruns_.load(std::memory_order_relaxed); }
  const LatenessHistogram& lateness() const { return lateness_; }
  // Wall time from one tick to the next.
  Clock::duration period() const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(tick_ns_) / speed_));
  }

 private:
  std::int64_t tick_ns_;
  double speed_ = 1.0;
  Clock::time_point due_{};
  std::chrono::nanoseconds lost_{0};
  std::atomic<std::uint64_t> overruns_{0};
  LatenessHistogram lateness_;
};

}  // namespace visum::cycle
