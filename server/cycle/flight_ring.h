// The peaks of the last 4096 ticks (fewer where a world is large), per joint and per body, so that a client
// that samples now and then still sees every peak.
//
// The tick's thread writes; any other thread may read at the same time. The numbers are relaxed atomics, and
// a row that is overwritten while it is read can only show the number of a newer tick. Holds at most
// kMostBytes, unless kLeastTicks need more.
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
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;

  FlightRing(std::size_t joints, std::size_t bodies);

  // Notes the following errors (by joint) and contact forces (by body) after tick number `tick`; 1 is the
  // first. Keeps their magnitudes.
  void record(std::int64_t tick, std::span<const double> errors, std::span<const double> forces);

  // Copies the ticks up to `until` from the ring of the world before a change. The spans give for each joint
  // and body of this ring its number in the other; invalid: it is new.
  void take_over(const FlightRing& other, std::int64_t until, std::span<const world::JointId> joints,
                 std::span<const world::BodyId> bodies);
  // Copies the ticks (after, until], which came since.
  void copy(const FlightRing& other, std::int64_t after, std::int64_t until,
            std::span<const world::JointId> joints, std::span<const world::BodyId> bodies);

  // Begins a new era: peaks() ignores all ticks up to `tick` from now on.
  void begin(std::int64_t tick) { begin_.store(tick, std::memory_order_relaxed); }

  // Largest magnitudes over the ticks (after, until], as far back as the ring reaches.
  void peaks(std::int64_t after, std::int64_t until, std::span<double> errors,
             std::span<double> forces) const;

  std::int64_t ticks() const { return ticks_; }  // how many the ring holds

 private:
  // Index of the tick's first number: errors of all joints, then forces of all bodies.
  std::size_t row(std::int64_t tick) const {
    return static_cast<std::size_t>(tick % ticks_) * (joints_ + bodies_);
  }

  std::size_t joints_, bodies_;
  std::int64_t ticks_;
  std::unique_ptr<std::atomic<double>[]> numbers_;
  std::atomic<std::int64_t> begin_{0};
};

}  // namespace visum::cycle
