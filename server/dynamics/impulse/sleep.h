// Sleeping, where the engine is asked to (`sleep`): what has stood still for so long, and all that it touches
// or is joined to, is left out of the steps until something changes. It keeps its place to the bit, its
// contacts and joints their forces.
//
// What wakes it: a body that touches it and does not sleep, a force on it, a contact that comes or goes, a
// drive that is given something else, a velocity that was set from outside.
//
// Units are the mechanisms, then the bodies that stand free. Format, in the engine's part of the world's
// state, after the warm start: one record for each unit, in that order. Native endianness.
#pragma once

#include <cstddef>
#include <vector>

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

class Sleep {
 public:
  explicit Sleep(const Plant& plant);

  bool is_wanted() const { return sleep_s_ > 0.0 && !records_.empty(); }
  std::size_t bytes() const;  // that it takes of the state's
  // Who sleeps in this tick: sets the plant's `asleep` marks, and stops those who fall asleep.
  void begin(const StepInput& input, const world::WorldState& state, const std::vector<std::byte>& bytes,
             Plant& plant);
  void write(std::vector<std::byte>& bytes) const;  // into the last bytes()

 private:
  struct Record {
    double still_s = 0.0;
    std::uint64_t drives = 0;  // hash of what the unit's drives were given
    std::uint64_t contacts = 0;
  };

  void read(const std::vector<std::byte>& bytes);
  void note_motion(const Plant& plant);
  void note_inputs(const StepInput& input, const Plant& plant);
  void note_contacts(const StepInput& input, const world::WorldState& state, const Plant& plant);
  void disturb(std::size_t unit) { records_[unit].still_s = 0.0; }
  void join(int body_a, int body_b);
  std::size_t island(std::size_t unit);
  void mark(Plant& plant);

  double sleep_s_;
  std::vector<std::size_t> unit_of_;  // by body
  std::vector<Record> records_;       // by unit
  std::vector<std::size_t> leader_;   // by unit: a forest whose roots are the islands' lowest units
  std::vector<std::uint64_t> drives_, contacts_;  // by unit, in this tick
};

}  // namespace visum::dynamics::impulse
