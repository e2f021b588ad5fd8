#include "server/cycle/flight_ring.h"

#include <algorithm>
#include <cmath>

namespace visum::cycle {

FlightRing::FlightRing(std::size_t joints, std::size_t bodies)
    : joints_(joints),
      bodies_(bodies),
      numbers_(
          std::make_unique<std::atomic<double>[]>(static_cast<std::size_t>(kTicks) * (joints + bodies))) {}

void FlightRing::record(std::int64_t tick, std::span<const double> errors, std::span<const double> forces) {
  auto* to = numbers_.get() + row(tick);
  for (double error : errors) (to++)->store(std::abs(error), std::memory_order_relaxed);
  for (double force : forces) (to++)->store(std::abs(force), std::memory_order_relaxed);
}

void FlightRing::peaks(std::int64_t after, std::int64_t until, std::span<double> errors,
                       std::span<double> forces) const {
  std::ranges::fill(errors, 0.0);
  std::ranges::fill(forces, 0.0);
  const std::int64_t first = std::max({after, until - kTicks, begin_.load(std::memory_order_relaxed)}) + 1;
  for (std::int64_t tick = first; tick <= until; ++tick) {
    const auto* from = numbers_.get() + row(tick);
    for (double& peak : errors) peak = std::max(peak, (from++)->load(std::memory_order_relaxed));
    for (double& peak : forces) peak = std::max(peak, (from++)->load(std::memory_order_relaxed));
  }
}

}  // namespace visum::cycle
