#include "server/dynamics/impulse/island_pool.h"

#include <system_error>

namespace visum::dynamics::impulse {

IslandPool::IslandPool(int threads) {
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

void IslandPool::take_turns(std::size_t worker) {
  for (std::size_t i = next_.fetch_add(1, std::memory_order_relaxed); i < count_;
       i = next_.fetch_add(1, std::memory_order_relaxed))
    call_(work_, worker, i);
}

void IslandPool::run_all(std::size_t count) {
  count_ = count;
  next_.store(0, std::memory_order_relaxed);
  busy_.store(static_cast<std::uint32_t>(others_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  take_turns(0);
  // Each thread takes part in each round, if only to find that nothing is left.
  for (std::uint32_t busy = busy_.load(std::memory_order_acquire); busy > 0;
       busy = busy_.load(std::memory_order_acquire))
    busy_.wait(busy, std::memory_order_acquire);
}

void IslandPool::serve(std::size_t worker) {
  for (std::uint32_t seen = 0;; ++seen) {
    round_.wait(seen, std::memory_order_acquire);
    if (ending_) return;
    take_turns(worker);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_one();
  }
}

}  // namespace visum::dynamics::impulse
