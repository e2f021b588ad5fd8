#include "server/cycle/network_model.h"

#include <algorithm>
#include <cmath>

namespace visum::cycle {
namespace {

constexpr std::size_t kLeastWrites = 1024, kWritesPerTick = 4;  // room for writes that are under way
constexpr double kNsPerMs = 1e6;

// For how many ticks a message can be under way: from the one in which it leaves to the last one in which it
// can arrive.
std::size_t most_ticks(const NetworkModel::Quality& quality) {
  return static_cast<std::size_t>(quality.delay_ticks + quality.jitter_ticks) + 2;
}

}  // namespace

void DelayLine::reset(std::size_t capacity, std::size_t width) {
  slots_.assign(capacity, {});
  numbers_.assign(capacity * width, 0.0);
  width_ = width;
  head_ = count_ = 0;
  last_due_ = 0;
}

void DelayLine::push(std::int64_t due_tick, std::size_t first, std::span<const double> numbers) {
  if (count_ == slots_.size() || numbers.size() > width_) return;
  last_due_ = std::max(last_due_, due_tick);
  const std::size_t at = slot(count_++);
  slots_[at] = {last_due_, first, numbers.size()};
  std::ranges::copy(numbers, numbers_.begin() + static_cast<std::ptrdiff_t>(at * width_));
}

std::span<const double> DelayLine::front() const {
  return std::span(numbers_).subspan(head_ * width_, slots_[head_].size);
}

void DelayLine::pop() {
  head_ = slot(1);
  --count_;
}

void DelayLine::pour_into(std::span<double> inputs) const {
  for (std::size_t n = 0; n < count_; ++n) {
    const auto& item = slots_[slot(n)];
    std::ranges::copy(std::span(numbers_).subspan(slot(n) * width_, item.size),
                      inputs.begin() + static_cast<std::ptrdiff_t>(item.first));
  }
}

void DelayLine::save(hwparts::StateWriter& to) const {
  to.put(last_due_), to.put(static_cast<std::uint64_t>(count_));
  for (std::size_t n = 0; n < count_; ++n) {
    const auto& item = slots_[slot(n)];
    to.put(item.due_tick), to.put(item.first), to.put(item.size);
    to.put(std::span(numbers_).subspan(slot(n) * width_, item.size));
  }
}

// The line has the capacity and width of the one that was saved.
void DelayLine::load(hwparts::StateReader& from) {
  std::uint64_t count = 0;
  head_ = 0;
  from.get(last_due_), from.get(count);
  count_ = std::min<std::size_t>(count, slots_.size());
  for (std::size_t n = 0; n < count_; ++n) {
    auto& item = slots_[n];
    from.get(item.due_tick), from.get(item.first), from.get(item.size);
    if (item.size > width_ || item.first > width_ - item.size)
      throw std::out_of_range("a message on its way holds more than the part has ports");
    from.get(std::span(numbers_).subspan(n * width_, item.size));
  }
}

NetworkModel::Quality NetworkModel::quality_of(std::span<const hwparts::ActiveFault> faults,
                                               std::int64_t tick_ns) {
  // A short delay is rounded up to one tick: rounded to none, it would be no delay at all.
  const auto ticks = [tick_ns](double ms) {
    const auto nearest = std::llround(ms * kNsPerMs / static_cast<double>(tick_ns));
    return ms > 0.0 ? std::max(nearest, 1LL) : nearest;
  };
  Quality quality;
  for (const auto& active : faults) {
    const auto& numbers = active.fault.numbers;
    if (active.fault.kind == hwparts::FaultKind::kNetworkLoss) quality.loss = numbers[0];
    if (active.fault.kind != hwparts::FaultKind::kNetworkDelay) continue;
    quality.delay_ticks = ticks(numbers[0]);
    quality.jitter_ticks = ticks(numbers[1]);
  }
  return quality;
}

Outcome NetworkModel::has_room_for(const hwparts::Fault& fault, const protocol::PartDescription& part,
                                   std::int64_t tick_ns) {
  if (fault.kind != hwparts::FaultKind::kNetworkDelay) return {};
  const hwparts::ActiveFault alone{0, fault, 0};
  const auto ticks = most_ticks(quality_of({&alone, 1}, tick_ns));
  const auto room = kMostBytes / (kWritesPerTick * DelayLine::bytes_per_slot(part.controller_inputs.size()) +
                                  DelayLine::bytes_per_slot(part.sensor_outputs.size()));
  if (ticks <= room) return {};
  return {Refusal::kBadValue, "with ticks of " + std::to_string(tick_ns) + " ns '" + part.name +
                                  "' would have " + std::to_string(ticks) +
                                  " ticks under way, and there is room for " + std::to_string(room)};
}

void NetworkModel::begin(const Quality& quality, std::uint64_t seed, std::span<const double> shown,
                         std::size_t inputs) {
  quality_ = quality;
  chance_ = sensors::Random(seed, "wire");
  readings_.assign(shown.begin(), shown.end());
  const auto ticks = most_ticks(quality);
  writes_.reset(std::max(kLeastWrites, kWritesPerTick * ticks), inputs);
  samples_.reset(ticks, shown.size());
}

std::int64_t NetworkModel::arrival(std::int64_t tick) {
  const double most = static_cast<double>(quality_.jitter_ticks);
  const double late = most > 0.0 ? std::floor(chance_.uniform() * (most + 1.0)) : 0.0;
  return tick + quality_.delay_ticks + static_cast<std::int64_t>(late);
}

void NetworkModel::send(std::int64_t tick, std::size_t first, std::span<const double> values) {
  if (!lost()) writes_.push(arrival(tick), first, values);
}

void NetworkModel::show(std::int64_t tick, std::span<double> shown) {
  if (!lost()) samples_.push(arrival(tick), 0, readings_);
  for (; samples_.due(tick); samples_.pop()) std::ranges::copy(samples_.front(), shown.begin());
}

void NetworkModel::save(hwparts::StateWriter& to) const {
  chance_.save(to);
  to.put(std::span<const double>(readings_));
  writes_.save(to);
  samples_.save(to);
}

void NetworkModel::load(hwparts::StateReader& from) {
  chance_.load(from);
  from.get(std::span<double>(readings_));
  writes_.load(from);
  samples_.load(from);
}

}  // namespace visum::cycle
