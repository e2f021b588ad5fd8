// A triple buffer: hands the latest value of something large from one thread to another, without a lock and
// without waiting. The writer fills its own copy and swaps it in; the reader takes the newest when it wants
// one. One writer thread, one reader thread. Values that the reader does not take are overwritten.
#pragma once

#include <array>
#include <atomic>

namespace visum::world {

template <typename T>
class Exchange {
 public:
  // Writer: its copy holds any older value, and has to be overwritten as a whole before publish().
  T& back() { return copies_[back_]; }
  void publish() { back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex; }

  // Reader: the newest value that was published before the last refresh().
  const T& front() const { return copies_[front_]; }
  // Reader: takes the newest value; false: nothing was published since.
  bool refresh() {
    if (!(middle_.load(std::memory_order_relaxed) & kFresh)) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }

 private:
  static constexpr unsigned kFresh = 4, kIndex = 3;
  std::array<T, 3> copies_{};
  // Indices into copies_: the writer's, the one in between, the reader's. Always three different ones.
  unsigned back_ = 0;
  std::atomic<unsigned> middle_{1};  // with kFresh where the reader has not seen it
  unsigned front_ = 2;
};

}  // namespace visum::world
