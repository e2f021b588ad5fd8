#include "server/gateway/relief.h"

#include <utility>

namespace visum::gateway {

using Clock = std::chrono::steady_clock;

Relief::Relief(Duties duties) : duties_(std::move(duties)), thread_([this] { run(); }) {}

Relief::~Relief() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Relief::leave() {
  absences_.fetch_add(1, std::memory_order_relaxed);
  state_.store(kAway, std::memory_order_release);
}

bool Relief::take_back() {
  std::uint32_t state = kAway;
  if (state_.compare_exchange_strong(state, kServing, std::memory_order_acquire)) return false;
  state_.store(kBack, std::memory_order_release);
  duties_.wake();
  while ((state = state_.load(std::memory_order_acquire)) != kServing) state_.wait(state);
  return true;
}

void Relief::run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kLook, [this] { return ended_; })) {
    lock.unlock();
    look();
    lock.lock();
  }
}

void Relief::look() {
  look_at_end();
  if (!duties_.relieve) return;
  const auto absence = absences_.load(std::memory_order_relaxed);
  if (state_.load(std::memory_order_relaxed) != kAway || absence != absence_) {
    absence_ = absence;
    looks_ = 0;
    return;
  }
  std::uint32_t away = kAway;
  if (++looks_ >= kLooksToRelieve &&
      state_.compare_exchange_strong(away, kRelieved, std::memory_order_acquire))
    stand_in();
}

void Relief::stand_in() {
  duties_.relieve(true);
  const auto is_away = [this] { return state_.load(std::memory_order_acquire) == kRelieved; };
  while (is_away()) {
    const auto until = Clock::now() + kLook;
    for (auto now = Clock::now(); is_away() && now < until; now = Clock::now()) duties_.serve(until - now);
    if (is_away()) look_at_end();
  }
  duties_.relieve(false);
  state_.store(kServing, std::memory_order_release);
  state_.notify_one();
}

void Relief::look_at_end() {
  const auto tick = duties_.tick();
  if (!duties_.is_to_end() || tick == 0 || tick != last_tick_) looks_at_end_ = 0;
  last_tick_ = tick;
  if (++looks_at_end_ > kLooksToAbandon) duties_.abandon(tick);
}

}  // namespace visum::gateway
