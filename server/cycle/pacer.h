// Pacing to the wall clock for clock realtime: when the next tick is due, and what to do when it is already
// late. Lives on the tick's thread; the counters may be read from others.
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

  // Simulated seconds per second of wall time, > 0. What is left until the next tick goes by that fast, too.
  void set_speed(double factor, Clock::time_point now);
  double speed() const { return speed_; }

  // Time starts now (after a pause, a reset): nothing is owed.
  void restart(Clock::time_point now) { due_ = now + period(); }

  Clock::time_point due() const { return due_; }

  // A tick begins at `now`. One that begins more than a period late is an overrun: counted, and what was
  // missed is dropped, so that no burst of ticks follows.
  void begin_tick(Clock::time_point now);

  std::uint64_t overruns() const { return overruns_.load(std::memory_order_relaxed); }
  const LatenessHistogram& lateness() const { return lateness_; }

 private:
  Clock::duration period() const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(static_cast<double>(tick_ns_) / speed_));
  }
  std::int64_t tick_ns_;
  double speed_ = 1.0;
  Clock::time_point due_{};
  std::atomic<std::uint64_t> overruns_{0};
  LatenessHistogram lateness_;
};

}  // namespace visum::cycle
