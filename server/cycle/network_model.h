// The network between a part and its controllers. A fault makes it late or lets it lose messages, in
// simulated time and by a seeded chance, so that equal runs are equal. Messages keep their order, as over
// TCP. Lives on the tick's thread, in a BoundPart; allocates only when its quality changes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hwparts/fault_set.h"
#include "hwparts/sensors/random.h"
#include "hwparts/state_archive.h"
#include "protocol/part_description.h"
#include "server/cycle/outcome.h"

namespace visum::cycle {

// The messages that are under way in one direction: a ring of bounded size. A message is some numbers for the
// ports from `first` on.
class DelayLine {
 public:
  // Empties the line and gives it room for `capacity` messages of at most `width` numbers.
  void reset(std::size_t capacity, std::size_t width);
  static std::size_t bytes_per_slot(std::size_t width) { return sizeof(Slot) + width * sizeof(double); }
  // The message is due no sooner than those before it. It is lost where the line is full.
  void push(std::int64_t due_tick, std::size_t first, std::span<const double> numbers);
  // The oldest message: whether it has arrived by `tick`, its first port, its numbers. Only while one is due.
  bool due(std::int64_t tick) const { return count_ > 0 && slots_[head_].due_tick <= tick; }
  std::size_t first() const { return slots_[head_].first; }
  std::span<const double> front() const;
  void pop();
  void clear() { head_ = count_ = 0; }
  // Time begins anew: every message is due so many ticks sooner.
  void move_dues(std::int64_t ticks) {
    for (auto& slot : slots_) slot.due_tick -= ticks;
    last_due_ -= ticks;
  }
  // Writes all messages over `inputs`, in their order, as if they had arrived.
  void pour_into(std::span<double> inputs) const;

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

  // Refuses a delay that is so long, counted in ticks, that more messages of the part would be under way than
  // kMostBytes hold. Pure; any thread.
  static Outcome has_room_for(const hwparts::Fault& fault, const protocol::PartDescription& part,
                              std::int64_t tick_ns);
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;  // of one part, both ways together

  bool ideal() const { return quality_ == Quality{}; }  // neither late nor lossy
  const Quality& quality() const { return quality_; }
  // Sets the quality; nothing is under way afterwards. `shown`: the part's readings as they are shown now.
  // `inputs`: how many controller inputs the part has. `seed`: of the chance that delays and loses.
  void begin(const Quality& quality, std::uint64_t seed, std::span<const double> shown, std::size_t inputs);

  // Sends a write that leaves its controller at `tick`; writes() gives it out when it is due.
  void send(std::int64_t tick, std::size_t first, std::span<const double> values);
  void move_dues(std::int64_t ticks) {
    writes_.move_dues(ticks);
    samples_.move_dues(ticks);
  }
  DelayLine& writes() { return writes_; }
  const DelayLine& writes() const { return writes_; }
  // The part fills readings() each tick. show() sends them and copies the newest that have arrived to
  // `shown`.
  std::vector<double>& readings() { return readings_; }
  void show(std::int64_t tick, std::span<double> shown);

  void save(hwparts::StateWriter& to) const;
  void load(hwparts::StateReader& from);

 private:
  bool lost() { return quality_.loss > 0.0 && chance_.uniform() < quality_.loss; }
  std::int64_t arrival(std::int64_t tick);  // of a message that leaves at `tick`; draws its jitter

  Quality quality_;
  sensors::Random chance_{1, "wire"};
  std::vector<double> readings_;
  DelayLine writes_, samples_;
};

}  // namespace visum::cycle
