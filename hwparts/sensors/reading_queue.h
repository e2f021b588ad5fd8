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
  // Of those that are due only the newest stays. How many went.
  std::size_t drop_overtaken(std::int64_t now_ns);
  // Those that were put in with `late_ns` more than usual, the newest ones, lose it. `in_time_ns`: when the
  // newest one is due at most if it is none of them. They must follow each other sooner than after late_ns.
  void hasten(std::int64_t late_ns, std::int64_t in_time_ns);
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
