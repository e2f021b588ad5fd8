#include "server/cycle/pacer.h"

namespace visum::cycle {

void Pacer::begin_tick(Clock::time_point now) {
  const auto late = now - due_;
  lateness_.add(std::chrono::duration_cast<std::chrono::nanoseconds>(late).count());
  due_ += period();
  if (late <= period()) return;
  overruns_.fetch_add(1, std::memory_order_relaxed);
  due_ = now + period();
}

}  // namespace visum::cycle
