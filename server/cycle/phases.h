// The cycle's profile: how long each phase of the tick takes, in wall time. It never influences the world.
// Lives on the tick's thread; other threads get copies of summary().
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace visum::cycle {

enum class Phase { kSense, kThink, kAct, kCollide, kStep, kPublish };
inline constexpr std::size_t kPhases = 6;
inline constexpr std::array<const char*, kPhases> kPhaseNames{"sense",   "think", "act",
                                                              "collide", "step",  "publish"};

class Phases {
 public:
  struct Time {
    std::int64_t mean_ns = 0;
    std::int64_t max_ns = 0;
  };
  using Summary = std::array<Time, kPhases>;

  // begin() starts the clock of a tick; end() stops it for the phase that ran since the call before.
  void begin() { last_ = Clock::now(); }
  void end(Phase phase) {
    const auto now = Clock::now();
    auto& bin = current_[static_cast<std::size_t>(phase)];
    const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
    bin.sum_ns += ns;
    if (ns > bin.max_ns) bin.max_ns = ns;
    last_ = now;
  }
  std::chrono::steady_clock::time_point last() const { return last_; }  // when the phase that runs began
  // Ends a tick: after about a second of wall time the summary is renewed.
  void tick_done() {
    ++ticks_;
    if (last_ - window_start_ < std::chrono::seconds(1)) return;
    for (std::size_t i = 0; i < kPhases; ++i) summary_[i] = {current_[i].sum_ns / ticks_, current_[i].max_ns};
    current_ = {};
    ticks_ = 0;
    window_start_ = last_;
  }
  // Covers the last full window of about a second.
  const Summary& summary() const { return summary_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Bin {
    std::int64_t sum_ns = 0;
    std::int64_t max_ns = 0;
  };
  std::array<Bin, kPhases> current_{};
  Summary summary_{};
  std::int64_t ticks_ = 0;
  Clock::time_point last_ = Clock::now();
  Clock::time_point window_start_ = Clock::now();
};

}  // namespace visum::cycle
