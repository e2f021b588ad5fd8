// The latest value of something big, handed from one thread to another without a lock and without waiting: a
// triple buffer. The writer fills its own copy and swaps it in; the reader takes the newest when it wants
// one.
#pragma once

#include <array>
#include <atomic>

namespace visum::world {

template <typename T>
class Exchange {
 public:
  // The writer's copy: any older value, to be overwritten whole.
  T& back() { return copies_[back_]; }
  void publish() { back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex; }

  // The reader's copy: the newest value published before the last refresh().
  const T& front() const { return copies_[front_]; }
  bool refresh() {
    if (!(middle_.load(std::memory_order_relaxed) & kFresh)) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }

 private:
  static constexpr unsigned kFresh = 4, kIndex = 3;
  std::array<T, 3> copies_{};
  unsigned back_ = 0;
  std::atomic<unsigned> middle_{1};
  unsigned front_ = 2;
};

}  // namespace visum::world
