// Readings on their way from the sample to the ports. All slots are made at the start; first in, first out.
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
  void clear() { first_ = count_ = 0; }

  void save(hwparts::StateWriter& to) const;  // what is in it, wherever it lies
  void load(hwparts::StateReader& from);

 private:
  std::size_t slot(std::size_t place) const { return (first_ + place) % due_ns_.size(); }

  std::size_t numbers_;
  std::vector<std::int64_t> due_ns_;  // by slot
  std::vector<double> values_;        // by slot, `numbers_` each
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace visum::sensors
