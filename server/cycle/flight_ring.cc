#include "server/cycle/flight_ring.h"

#include <algorithm>
#include <cmath>

namespace visum::cycle {
namespace {

std::int64_t ticks_with_room(std::size_t numbers) {
  const auto row_bytes = std::max<std::size_t>(numbers, 1) * sizeof(double);
  return std::clamp(static_cast<std::int64_t>(FlightRing::kMostBytes / row_bytes), FlightRing::kLeastTicks,
                    FlightRing::kTicks);
}

}  // namespace

FlightRing::FlightRing(std::size_t joints, std::size_t bodies)
    : joints_(joints),
      bodies_(bodies),
      ticks_(ticks_with_room(joints + bodies)),
      numbers_(
          std::make_unique<std::atomic<double>[]>(static_cast<std::size_t>(ticks_) * (joints + bodies))) {}

void FlightRing::record(std::int64_t tick, std::span<const double> errors, std::span<const double> forces) {
  auto* to = numbers_.get() + row(tick);
  for (double error : errors) (to++)->store(std::abs(error), std::memory_order_relaxed);
  for (double force : forces) (to++)->store(std::abs(force), std::memory_order_relaxed);
}

void FlightRing::take_over(const FlightRing& other, std::int64_t until,
                           std::span<const world::JointId> joints, std::span<const world::BodyId> bodies) {
  const auto before =
      std::max(other.begin_.load(std::memory_order_relaxed), until - std::min(ticks_, other.ticks_));
  begin(before);
  copy(other, before, until, joints, bodies);
}

void FlightRing::copy(const FlightRing& other, std::int64_t after, std::int64_t until,
                      std::span<const world::JointId> joints, std::span<const world::BodyId> bodies) {
  after = std::max(after, until - std::min(ticks_, other.ticks_));
  for (std::int64_t tick = after + 1; tick <= until; ++tick) {
    const auto* from = other.numbers_.get() + other.row(tick);
    auto* to = numbers_.get() + row(tick);
    const auto take = [&](const auto& kept, std::size_t others) {
      for (std::size_t i = 0; i < kept.size(); ++i)
        to[i].store(kept[i].valid() ? from[kept[i].index()].load(std::memory_order_relaxed) : 0.0,
                    std::memory_order_relaxed);
      to += kept.size(), from += others;
    };
    take(joints, other.joints_);
    take(bodies, other.bodies_);
  }
}

void FlightRing::peaks(std::int64_t after, std::int64_t until, std::span<double> errors,
                       std::span<double> forces) const {
  std::ranges::fill(errors, 0.0);
  std::ranges::fill(forces, 0.0);
  const std::int64_t first = std::max({after, until - ticks_, begin_.load(std::memory_order_relaxed)}) + 1;
  for (std::int64_t tick = first; tick <= until; ++tick) {
    const auto* from = numbers_.get() + row(tick);
    for (double& peak : errors) peak = std::max(peak, (from++)->load(std::memory_order_relaxed));
    for (double& peak : forces) peak = std::max(peak, (from++)->load(std::memory_order_relaxed));
  }
}

}  // namespace visum::cycle
