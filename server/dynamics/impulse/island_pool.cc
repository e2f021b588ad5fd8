#include "server/dynamics/impulse/island_pool.h"

#include <system_error>

namespace visum::dynamics::impulse {
namespace {

// So many looks take 19 us on an AMD EPYC, and more where a pause is longer. A thread that wakes up takes
// about as long, and within a tick the next round comes soon.
constexpr int kMostLooks = 1000;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

// Threads that have no processor of their own leave it to each other at once.
IslandPool::IslandPool(int threads)
    : shares_(static_cast<std::size_t>(threads)),
      most_looks_(static_cast<unsigned>(threads) <= std::thread::hardware_concurrency() ? kMostLooks : 0) {
  try {
    for (int i = 1; i < threads; ++i)
      others_.emplace_back([this, worker = static_cast<std::size_t>(i)] { serve(worker); });
  } catch (const std::system_error&) {
    end();
    throw;
  }
}

IslandPool::~IslandPool() {
  end();
}

void IslandPool::end() {
  ending_ = true;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (std::thread& other : others_) other.join();
}

void IslandPool::await_change(const std::atomic<std::uint32_t>& number, std::uint32_t old) const {
  for (int i = 0; i < most_looks_; ++i, pause())
    if (number.load(std::memory_order_acquire) != old) return;
  number.wait(old, std::memory_order_acquire);
}

void IslandPool::take_turns(std::size_t worker, Share& share, bool own) noexcept {
  std::uint64_t left = share.left.load(std::memory_order_relaxed);
  for (;;) {
    const std::size_t first = left >> 32, end = left & UINT32_MAX;
    if (first >= end) return;
    const std::uint64_t rest = own ? pack(first + 1, end) : pack(first, end - 1);
    if (!share.left.compare_exchange_weak(left, rest, std::memory_order_relaxed)) continue;
    call_(work_, worker, own ? first : end - 1);
    left = share.left.load(std::memory_order_relaxed);
  }
}

void IslandPool::take_all_turns(std::size_t worker) {
  for (std::size_t i = 0; i < threads(); ++i) take_turns(worker, shares_[(worker + i) % threads()], i == 0);
}

void IslandPool::run_all() {
  busy_.store(static_cast<std::uint32_t>(others_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  take_all_turns(0);
  // Each thread takes part in each round, if only to find that nothing is left.
  for (std::uint32_t busy = busy_.load(std::memory_order_acquire); busy > 0;
       busy = busy_.load(std::memory_order_acquire))
    await_change(busy_, busy);
}

void IslandPool::serve(std::size_t worker) {
  for (std::uint32_t seen = 0;; ++seen) {
    await_change(round_, seen);
    if (ending_) return;
    take_all_turns(worker);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
  }
}

}  // namespace visum::dynamics::impulse
