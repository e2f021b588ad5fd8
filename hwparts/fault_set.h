// The faults that act, of all parts together. Plain: saving it saves them. Lives on the tick's thread;
// nothing here allocates after construction.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hwparts/fault_kinds.h"
#include "hwparts/state_archive.h"

namespace visum::hwparts {

struct ActiveFault {
  std::uint32_t part = 0;
  Fault fault;
  std::int64_t until_tick = 0;  // the first tick without it; 0: until it is cleared
};

class FaultSet {
 public:
  static constexpr std::size_t kMost = 1024;

  FaultSet() { active_.reserve(kMost); }

  // Takes the place of one of the same kind there. False: kMost act already.
  bool inject(const ActiveFault& fault);
  // Of one part; `kind` nothing: all; `drive` nothing: of all its drives. How many there were.
  std::size_t clear(std::uint32_t part, std::optional<FaultKind> kind, std::optional<std::size_t> drive);
  void clear_all() { active_.clear(); }
  // Those that are over at `tick` go. True: there were some.
  bool expire(std::int64_t tick);

  // By part, then as they came.
  std::span<const ActiveFault> all() const { return active_; }
  std::span<const ActiveFault> of(std::uint32_t part) const;
  const ActiveFault* find(std::uint32_t part, FaultKind kind) const;

  void save(StateWriter& to) const;
  // Believes nothing; `parts`: how many there are.
  void load(StateReader& from, std::size_t parts);

 private:
  std::vector<ActiveFault> active_;
};

}  // namespace visum::hwparts
