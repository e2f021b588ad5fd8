// The times at which a sensor samples and shows its readings. They are whole nanoseconds since the start, so
// a sensor's rate need not divide the tick's. A plain value.
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

// Reads `rate_hz` (default: every tick) and `latency_ms` (default: 0) of a sensor's entry. Throws
// ConfigError.
Timing read_timing(const config::Node& entry, std::int64_t tick_ns);

}  // namespace visum::sensors
