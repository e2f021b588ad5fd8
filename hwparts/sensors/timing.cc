#include "hwparts/sensors/timing.h"

#include <cmath>

namespace visum::sensors {

Timing read_timing(const config::Node& entry, std::int64_t tick_ns) {
  constexpr double kSlowest_hz = 1e-3;
  Timing timing{tick_ns, tick_ns, 0};
  const double fastest_hz = 1e9 / static_cast<double>(tick_ns);
  if (const auto rate = entry.find("rate_hz")) {
    const double hz = rate->number({kSlowest_hz, fastest_hz});
    timing.period_ns = std::max(tick_ns, static_cast<std::int64_t>(std::llround(1e9 / hz)));
  }
  if (const auto latency = entry.find("latency_ms")) {
    const double most_ms = static_cast<double>(timing.period_ns) * kMaxSamplesOnTheWay * 1e-6;
    timing.latency_ns = std::llround(latency->number({0.0, most_ms}) * 1e6);
  }
  return timing;
}

}  // namespace visum::sensors
