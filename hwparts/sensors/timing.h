// When a sensor samples, and when a reading is seen: whole nanoseconds since the start, so that a rate need
// not be a divisor of the tick's.
#pragma once

#include <cstdint>

#include "protocol/config/config.h"

namespace visum::sensors {

struct Timing {
  std::int64_t tick_ns = 0;
  std::int64_t period_ns = 0;   // at least a tick
  std::int64_t latency_ns = 0;  // from the sample to the ports

  // Samples are due at whole periods, the first after one period.
  bool samples_between(std::int64_t before_ns, std::int64_t now_ns) const {
    return now_ns / period_ns > before_ns / period_ns;
  }
};

inline constexpr int kMaxSamplesOnTheWay = 100;

// `rate_hz` (each tick without it) and `latency_ms` (0) of a sensor's entry.
Timing read_timing(const config::Node& entry, std::int64_t tick_ns);

}  // namespace visum::sensors
