#include "server/cycle/behind_watch.h"

#include <cstdio>

namespace visum::cycle {

std::optional<std::string> BehindWatch::look(Clock::time_point now, std::chrono::nanoseconds lost,
                                             std::uint64_t overruns) {
  if (!window_began_) window_began_ = now;
  if (now - *window_began_ < kWindow) return {};
  const std::chrono::duration<double> window = now - *window_began_, lost_in_it = lost - at_window_.lost;
  const Counts counts{lost, overruns};
  window_began_ = now;
  at_window_ = counts;
  if (lost_in_it > kLeastLost * window) {
    good_windows_ = 0;
    if (told_at_ && now - *told_at_ < kPause) return {};
    told_at_ = now;
    behind_ = true;
    return "the world falls behind the wall clock: " + since_told(counts);
  }
  if (!behind_ || ++good_windows_ < kGoodWindows) return {};
  behind_ = false;
  return "the world keeps up with the wall clock again: " + since_told(counts);
}

std::string BehindWatch::since_told(const Counts& now) {
  char text[128];
  std::snprintf(text, sizeof text, "%llu ticks came too late, and %.3f s were lost",
                static_cast<unsigned long long>(now.overruns - at_told_.overruns),
                std::chrono::duration<double>(now.lost - at_told_.lost).count());
  at_told_ = now;
  return text;
}

}  // namespace visum::cycle
