// Shows what a tick is doing just now, for threads that cannot wait for its end.
#pragma once

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace visum::cycle {

enum class Stage : std::uint8_t { kNothing, kSense, kThink, kAct, kCollide, kStep, kPublish };

// The tick's thread notes its stages here; any thread may look. A tick can be abandoned: then nobody records
// it, and the tick's thread never comes back from it. That is for a process that ends. The Simulation owns
// it.
class Working {
 public:
  using Clock = std::chrono::steady_clock;
  struct Now {
    Stage stage = Stage::kNothing;
    std::uint32_t index = 0;  // kThink: of the agent, kAct: of the part, kStep: of the engine
    Clock::time_point since{};
  };

  // The tick's thread.
  void begin(std::int64_t border) {
    border_.store(border, std::memory_order_relaxed);
    tick_.store(++ticks_, std::memory_order_release);
  }
  // `since`: when the stage began.
  void enter(Stage stage, std::uint32_t index, Clock::time_point since) {
    since_.store(since.time_since_epoch().count(), std::memory_order_relaxed);
    stage_.store(static_cast<std::uint64_t>(stage) << 32 | index, std::memory_order_release);
  }
  void enter(Stage stage, std::uint32_t index) {  // that began together with the one before
    stage_.store(static_cast<std::uint64_t>(stage) << 32 | index, std::memory_order_release);
  }
  // The world has done its tick; nobody has seen that yet. Does not return where it was abandoned.
  void end() {
    stage_.store(0, std::memory_order_relaxed);
    if (tick_.exchange(0, std::memory_order_acq_rel) != kAbandoned) return;
    tick_.store(kAbandoned, std::memory_order_relaxed);
    for (;;) ::pause();
  }

  // Any thread.
  Now now() const {
    const auto stage = stage_.load(std::memory_order_acquire);
    return {static_cast<Stage>(stage >> 32), static_cast<std::uint32_t>(stage),
            Clock::time_point(Clock::duration(since_.load(std::memory_order_relaxed)))};
  }
  // The number of the tick that is being done, counted from the start; 0: none is.
  std::uint64_t tick() const { return tick_.load(std::memory_order_acquire); }
  // The tick border at which that tick, or else the one before, began.
  std::int64_t border() const { return border_.load(std::memory_order_relaxed); }
  // From now on the tick's thread changes nothing outside the world. False: that tick is over.
  bool abandon(std::uint64_t tick) {
    return tick_.compare_exchange_strong(tick, kAbandoned, std::memory_order_acq_rel);
  }

 private:
  static constexpr std::uint64_t kAbandoned = ~std::uint64_t{0};
  std::atomic<std::uint64_t> tick_{0};
  std::atomic<std::uint64_t> stage_{0};
  std::atomic<Clock::rep> since_{0};
  std::atomic<std::int64_t> border_{0};
  std::uint64_t ticks_ = 0;  // the tick's thread
};

}  // namespace visum::cycle
