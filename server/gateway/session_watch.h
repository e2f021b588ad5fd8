// Notices on the tick's thread that the sessions' thread does not come round any more.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace visum::gateway {

// Lives on the tick's thread, in clock realtime only. It measures silence by the time in which the tick's
// thread itself was awake: each look counts for kLongestLook at most. So a process that was stopped as a
// whole, or held by a debugger, was not silent.
class SessionWatch {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kLongestLook{25};  // more than the loop ever sleeps

  // `limit` 0: nobody is watched.
  void set_limit(std::chrono::milliseconds limit) { limit_ = limit; }
  // `beats` counts how often the sessions' thread has come round. True once for each silence, as soon as it
  // has lasted for the limit.
  bool look(std::uint64_t beats, Clock::time_point now) {
    const auto passed = std::clamp<Clock::duration>(now - last_look_, Clock::duration::zero(), kLongestLook);
    last_look_ = now;
    if (beats != beats_) {
      beats_ = beats;
      silence_ = {};
      return false;
    }
    const bool was_silent = silence_ >= limit_;
    silence_ += passed;
    return limit_.count() > 0 && !was_silent && silence_ >= limit_;
  }

 private:
  std::chrono::milliseconds limit_{0};
  std::uint64_t beats_ = 0;
  Clock::time_point last_look_{};
  Clock::duration silence_{};
};

}  // namespace visum::gateway
