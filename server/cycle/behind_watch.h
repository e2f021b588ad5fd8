// Decides when the log says that a world in real time falls behind the wall clock: at once, then once a
// minute, and when it keeps up again. It has no clock and writes nothing itself. On the tick's thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace visum::cycle {

class BehindWatch {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::chrono::seconds kWindow{1};
  static constexpr double kLeastLost = 0.02;        // of a window: the world is behind
  static constexpr int kGoodWindows = 10;           // in a row: it keeps up again
  static constexpr std::chrono::minutes kPause{1};  // between two lines that say that it is behind

  // After each tick: the time that was dropped since the start because ticks came too late, and the number of
  // these ticks. Returns the line for the log, if there is one to write.
  std::optional<std::string> look(Clock::time_point now, std::chrono::nanoseconds lost,
                                  std::uint64_t overruns);

 private:
  struct Counts {
    std::chrono::nanoseconds lost{0};
    std::uint64_t overruns = 0;
  };
  std::string since_told(const Counts& now);

  std::optional<Clock::time_point> window_began_, told_at_;
  Counts at_window_, at_told_;
  bool behind_ = false;  // and the log says so
  int good_windows_ = 0;
};

}  // namespace visum::cycle
