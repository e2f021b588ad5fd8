// A rate limit: `per_second` tokens a second, with bursts of one second's worth. The caller passes the time,
// so that tests need no clock. Not thread-safe.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace visum::protocol {

class TokenBucket {
 public:
  using Time = std::chrono::steady_clock::time_point;

  TokenBucket(double per_second, Time now) : per_second_(per_second), tokens_(capacity()), filled_(now) {}

  // Takes one token. Returns false if there is none.
  bool take(Time now) {
    refill(now);
    if (tokens_ < 1.0) return false;
    tokens_ -= 1.0;
    return true;
  }
  bool is_full(Time now) const { return tokens_at(now) >= capacity(); }
  // The time until the next token. Call it after take() returned false.
  std::chrono::nanoseconds wait() const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>((1.0 - tokens_) / per_second_ * 1e9) + 1);
  }

 private:
  double capacity() const { return std::max(1.0, per_second_); }
  double tokens_at(Time now) const {
    const double seconds = std::chrono::duration<double>(now - filled_).count();
    return std::min(capacity(), tokens_ + seconds * per_second_);
  }
  void refill(Time now) {
    tokens_ = tokens_at(now);
    filled_ = now;
  }

  double per_second_;
  double tokens_;
  Time filled_;
};

}  // namespace visum::protocol
