// A rate limit that allows bursts of one second's worth. Time is given, not taken.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace visum::protocol {

class TokenBucket {
 public:
  using Time = std::chrono::steady_clock::time_point;

  TokenBucket(double per_second, Time now) : per_second_(per_second), tokens_(capacity()), filled_(now) {}

  // Takes one token if there is one.
  bool take(Time now) {
    refill(now);
    if (tokens_ < 1.0) return false;
    tokens_ -= 1.0;
    return true;
  }
  // How long until the next token, after take() failed.
  std::chrono::nanoseconds wait() const {
    return std::chrono::nanoseconds(static_cast<std::int64_t>((1.0 - tokens_) / per_second_ * 1e9) + 1);
  }

 private:
  double capacity() const { return std::max(1.0, per_second_); }
  void refill(Time now) {
    const double seconds = std::chrono::duration<double>(now - filled_).count();
    tokens_ = std::min(capacity(), tokens_ + seconds * per_second_);
    filled_ = now;
  }

  double per_second_;
  double tokens_;
  Time filled_;
};

}  // namespace visum::protocol
