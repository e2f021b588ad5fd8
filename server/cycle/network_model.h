// The network between a part and its controllers, where a fault slows it or loses what goes over it: in
// simulated time, from a seed, so that equal runs are equal. What is under way keeps its order, as over TCP.
// Lives on the tick's thread; allocates only when its quality changes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hwparts/fault_set.h"
#include "hwparts/sensors/random.h"
#include "hwparts/state_archive.h"
#include "protocol/part_description.h"

namespace visum::cycle {

// Numbers on their way in one direction, in their order.
class DelayLine {
 public:
  void reset(std::size_t capacity, std::size_t width);
  static std::size_t bytes_per_slot(std::size_t width) { return sizeof(Slot) + width * sizeof(double); }
  // Not before those ahead of it. Where the delay_line is full it is lost.
  void push(std::int64_t due_tick, std::size_t first, std::span<const double> numbers);
  bool due(std::int64_t tick) const { return count_ > 0 && slots_[head_].due_tick <= tick; }
  std::size_t first() const { return slots_[head_].first; }
  std::span<const double> front() const;
  void pop();
  void clear() { head_ = count_ = 0; }
  void pour_into(std::span<double> inputs) const;  // all that is under way, in its order

  void save(hwparts::StateWriter& to) const;
  void load(hwparts::StateReader& from);

 private:
  struct Slot {
    std::int64_t due_tick = 0;
    std::uint64_t first = 0, size = 0;
  };
  std::size_t slot(std::size_t n) const { return (head_ + n) % slots_.size(); }

  std::vector<Slot> slots_;
  std::vector<double> numbers_;  // width_ for each slot
  std::size_t width_ = 0, head_ = 0, count_ = 0;
  std::int64_t last_due_ = 0;
};

class NetworkModel {
 public:
  struct Quality {
    std::int64_t delay_ticks = 0, jitter_ticks = 0;
    double loss = 0.0;
    bool operator==(const Quality&) const = default;
  };
  static Quality quality_of(std::span<const hwparts::ActiveFault> faults, std::int64_t tick_ns);

  // Why a fault of a part cannot act: more would be under way than there is room for. Nothing: it can.
  static std::optional<std::string> refuse(const hwparts::Fault& fault, const protocol::PartDescription& part,
                                           std::int64_t tick_ns);
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;  // of one part, there and back

  bool ideal() const { return quality_ == Quality{}; }
  const Quality& quality() const { return quality_; }
  // Nothing is under way then. `shown`: the part's readings; `inputs`: how many numbers it can be written.
  void begin(const Quality& quality, std::uint64_t seed, std::span<const double> shown, std::size_t inputs);

  // A write that leaves its controller at `tick`, and those that have arrived by then.
  void send(std::int64_t tick, std::size_t first, std::span<const double> values);
  DelayLine& writes() { return writes_; }
  const DelayLine& writes() const { return writes_; }
  // The part's own readings, to be filled each tick; then what of them has arrived.
  std::vector<double>& readings() { return readings_; }
  void show(std::int64_t tick, std::span<double> shown);

  void save(hwparts::StateWriter& to) const;
  void load(hwparts::StateReader& from);

 private:
  bool lost() { return quality_.loss > 0.0 && chance_.uniform() < quality_.loss; }
  std::int64_t arrival(std::int64_t tick);

  Quality quality_;
  sensors::Random chance_{1, "wire"};
  std::vector<double> readings_;
  DelayLine writes_, samples_;
};

}  // namespace visum::cycle
