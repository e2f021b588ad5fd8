// The numbers of parts in the gateway. Parts of models come and go while sessions, inputs on their way and
// emergency stops know them by a number, so a number belongs to a part as long as that is there. A number
// that is free again may be given anew, with another generation.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/cycle/simulation.h"

namespace visum::gateway {

// Constant; any thread. It keeps the parts alive for readers on other threads.
struct PartTable {
  struct Slot {
    std::shared_ptr<const hwparts::Part> part;  // of a free number: no_part()
    std::string agent;                          // that commands it; empty: clients may
    std::uint32_t generation = 0;               // how often the number became free
  };
  std::vector<Slot> slots;
  std::vector<std::uint32_t> slot_of;  // by number in Simulation::parts()
  std::uint64_t scene_number = 0;      // of the world's scene: another number, another scene
  std::string scene;                   // its name
  std::chrono::nanoseconds lockstep_timeout{};
};

// The numbers of `now` that mean another part than in `before`, or none where one was, or one where none was.
std::vector<std::uint32_t> changed_parts(const PartTable& before, const PartTable& now);

// Stands where no part is: it has no name, no ports and no joints.
std::shared_ptr<const hwparts::Part> no_part();

// Gives out the numbers. The scene's own parts have those that they have in the Simulation, also after
// another scene was loaded; the others get the lowest free ones. Lives on the tick's thread, owned by the
// TickSide.
class PartNumbers {
 public:
  explicit PartNumbers(const cycle::Simulation& simulation);

  // How many numbers there can be, whatever scene is loaded.
  std::size_t most() const { return most_; }
  // Looks at the parts that there are now; true: they are others than before.
  bool follow();
  const std::shared_ptr<const PartTable>& table() const { return table_; }
  // The part's number in Simulation::parts(); nothing: that part is gone.
  std::optional<std::uint32_t> find(std::uint32_t slot, std::uint32_t generation) const;
  std::optional<std::uint32_t> find(std::uint32_t slot) const { return index_[slot]; }
  std::uint32_t generation(std::uint32_t slot) const { return table_->slots[slot].generation; }

 private:
  const cycle::Simulation& simulation_;
  const std::size_t most_;
  std::shared_ptr<const PartTable> table_;
  std::vector<std::optional<std::uint32_t>> index_;  // by slot: its number in Simulation::parts()
};

}  // namespace visum::gateway
