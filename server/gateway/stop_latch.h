// The way of an emergency stop to the tick, which depends on nothing else: no queue, no lock, no log.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace visum::gateway {

// Remembers which parts shall stop until the tick's thread comes by. Any number of threads press it; one
// thread, the tick's, takes what was pressed. Owned by the TickSide; it must outlive all that press it.
//
// Each press returns a ticket. has_acted() says of a ticket whether its parts have stopped.
class StopLatch {
 public:
  explicit StopLatch(std::size_t parts) : pressed_(parts) {}

  // Any thread. Never waits, never fails. `part` < parts().
  std::uint64_t press(std::size_t part) {
    pressed_[part].store(true, std::memory_order_release);
    return asked_.fetch_add(1, std::memory_order_acq_rel) + 1;
  }
  std::uint64_t press_all() {
    for (auto& pressed : pressed_) pressed.store(true, std::memory_order_release);
    return asked_.fetch_add(1, std::memory_order_acq_rel) + 1;
  }
  bool has_acted(std::uint64_t ticket) const { return acted_.load(std::memory_order_acquire) >= ticket; }
  // The tick border at which the newest stop acted. Only after has_acted().
  std::int64_t tick() const { return tick_.load(std::memory_order_relaxed); }
  std::size_t parts() const { return pressed_.size(); }

  // The tick's thread. One relaxed load where nothing was pressed.
  bool is_pressed() const { return asked_.load(std::memory_order_relaxed) != taken_; }
  // Calls stop(part) for each part that was pressed since the last call.
  template <typename Stop>
  void take(const Stop& stop) {
    taken_ = asked_.load(std::memory_order_acquire);
    for (std::size_t part = 0; part < pressed_.size(); ++part)
      if (pressed_[part].exchange(false, std::memory_order_acquire)) stop(part);
  }
  // Everything that was taken has acted, at this tick border.
  void tell(std::int64_t tick) {
    if (taken_ == acted_.load(std::memory_order_relaxed)) return;
    tick_.store(tick, std::memory_order_relaxed);
    acted_.store(taken_, std::memory_order_release);
  }

 private:
  std::vector<std::atomic<bool>> pressed_;  // by part
  std::atomic<std::uint64_t> asked_{0};     // presses so far
  std::atomic<std::uint64_t> acted_{0};     // of those, the ones whose parts have stopped
  std::atomic<std::int64_t> tick_{0};
  std::uint64_t taken_ = 0;  // the tick's thread: presses that it has seen
};

}  // namespace visum::gateway
