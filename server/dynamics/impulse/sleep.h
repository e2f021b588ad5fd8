// Sleeping, where the engine's setting `sleep` asks for it. A unit that has stood still for that many
// seconds, together with everything that it touches or is joined to, is left out of the steps until something
// changes. It keeps its place to the bit, and its contacts and joints keep their forces.
//
// It wakes up when a body touches it that does not sleep, when a force acts on it, when a contact comes or
// goes, when a drive is given something else, or when a velocity is set from outside.
//
// A unit is a mechanism or a body without joints; mechanisms come first. Format, in the engine's part of the
// world's state, after the warm start: one record for each unit, in that order. Native endianness.
#pragma once

#include <cstddef>
#include <vector>

#include "server/dynamics/impulse/plant.h"
#include "server/world/disjoint_sets.h"

namespace visum::dynamics::impulse {

// Decides in each tick which units sleep. Order of calls: begin(), the step, write(). ImpulseEngine owns it;
// tick's thread. Nothing fails: bytes of another engine mean that nothing sleeps.
class Sleep {
 public:
  explicit Sleep(const Plant& plant);

  bool is_wanted() const { return sleep_s_ > 0.0 && !records_.empty(); }
  std::size_t bytes() const;  // that it takes of the engine's part of the state
  // Decides which units sleep in this tick. Sets the plant's `asleep` marks, and stops the bodies that fall
  // asleep.
  void begin(const StepInput& input, const world::WorldState& state, const std::vector<std::byte>& bytes,
             Plant& plant);
  void write(std::vector<std::byte>& bytes) const;  // into the last bytes() of them

 private:
  // The record of a unit from tick to tick.
  struct Record {
    double still_s = 0.0;        // how long it has stood still
    std::uint64_t drives = 0;    // hash of what the unit's drives were given
    std::uint64_t contacts = 0;  // number of them
  };

  void read(const std::vector<std::byte>& bytes);
  // Three looks for what disturbs a unit: its motion, its forces and drives, its contacts.
  void note_motion(const Plant& plant);
  void note_inputs(const StepInput& input, const Plant& plant);
  void note_contacts(const StepInput& input, const world::WorldState& state, const Plant& plant);
  // The unit has not stood still.
  void disturb(std::size_t unit) { records_[unit].still_s = 0.0; }
  // Puts the units of two bodies into one island.
  void join(int body_a, int body_b);
  // Sets the plant's marks, island by island.
  void mark(Plant& plant);

  double sleep_s_;
  std::vector<std::size_t> unit_of_;  // by body
  std::vector<Record> records_;       // by unit
  world::DisjointSets islands_;       // of units; unlike Islands, sleeping contacts join them, too
  std::vector<std::uint64_t> drives_, contacts_;  // by unit, in this tick
};

}  // namespace visum::dynamics::impulse
