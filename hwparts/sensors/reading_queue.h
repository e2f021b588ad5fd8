// The readings on their way from the sample to the ports, first in, first out. A sensor owns it. All slots
// are made at the start, so nothing allocates later.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hwparts/state_archive.h"

namespace visum::sensors {

class ReadingQueue {
 public:
  ReadingQueue(std::size_t slots, std::size_t numbers);

  bool empty() const { return count_ == 0; }
  // False where all slots are in use: the reading is lost.
  bool push(std::int64_t due_ns, std::span<const double> reading);
  std::int64_t front_due_ns() const { return due_ns_[first_]; }
  std::span<const double> front() const;
  void pop();
  // Drops the readings that are due, except the newest of them. Returns how many it dropped.
  std::size_t drop_overtaken(std::int64_t now_ns);
  // Takes an extra delay of `late_ns` off the readings that were pushed with it: these are the newest ones.
  // `in_time_ns`: the latest time at which the newest one can be due without the extra delay. Readings must
  // follow each other at intervals below late_ns.
  void hasten(std::int64_t late_ns, std::int64_t in_time_ns);
  void clear() { first_ = count_ = 0; }

  void save(hwparts::StateWriter& to) const;  // the readings in order, independent of their slots
  void load(hwparts::StateReader& from);

 private:
  std::size_t slot(std::size_t place) const { return (first_ + place) % due_ns_.size(); }

  std::size_t numbers_;
  std::vector<std::int64_t> due_ns_;  // by slot
  std::vector<double> values_;        // by slot, `numbers_` each
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace visum::sensors
