// What happened in the last 4096 ticks (fewer where a world is large), per joint and per body, so that a
// reader that samples now and then still sees every peak. Written on the tick's thread; read from any one
// other thread at the same time: the numbers are relaxed atomics, and a row that was overwritten meanwhile
// can only show a newer tick's number.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "server/world/ids.h"

namespace visum::cycle {

class FlightRing {
 public:
  static constexpr std::int64_t kTicks = 4096, kLeastTicks = 256;
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;  // with more than kLeastTicks

  FlightRing(std::size_t joints, std::size_t bodies);

  // The state after tick number `tick` (1 is the first). `errors` per joint, `forces` per body; magnitudes
  // are kept.
  void record(std::int64_t tick, std::span<const double> errors, std::span<const double> forces);

  // What another ring recorded, up to `until`, before bodies were added behind its own, or `gone` went.
  void take_over(const FlightRing& other, std::int64_t until, world::BodyId gone);

  // What was recorded is of another era: nothing up to `tick` is looked at any more.
  void begin(std::int64_t tick) { begin_.store(tick, std::memory_order_relaxed); }

  // Largest magnitudes over the ticks (after, until], as far as they are still there.
  void peaks(std::int64_t after, std::int64_t until, std::span<double> errors,
             std::span<double> forces) const;

  std::int64_t ticks() const { return ticks_; }  // that it holds

 private:
  std::size_t row(std::int64_t tick) const {
    return static_cast<std::size_t>(tick % ticks_) * (joints_ + bodies_);
  }

  std::size_t joints_, bodies_;
  std::int64_t ticks_;
  std::unique_ptr<std::atomic<double>[]> numbers_;
  std::atomic<std::int64_t> begin_{0};
};

}  // namespace visum::cycle
