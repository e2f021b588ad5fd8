#include "server/cycle/pacer.h"

namespace visum::cycle {

void Pacer::set_speed(double factor, Clock::time_point now) {
  const double slower = speed_ / factor;
  speed_ = factor;
  if (due_ <= now) return;
  due_ = now + std::chrono::duration_cast<Clock::duration>((due_ - now) * slower);
}

void Pacer::begin_tick(Clock::time_point now) {
  const auto late = now - due_;
  lateness_.add(std::chrono::duration_cast<std::chrono::nanoseconds>(late).count());
  due_ += period();
  if (late <= period()) return;
  overruns_.fetch_add(1, std::memory_order_relaxed);
  lost_ += std::chrono::duration_cast<std::chrono::nanoseconds>(late);
  due_ = now + period();
}

}  // namespace visum::cycle
