// The list of all faults on purpose that act now, of all parts. The simulation owns it, saves it with the
// world, and hands each part its own. It lives on the tick's thread; nothing here allocates after
// construction.
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

  // Replaces a fault of the same kind in the same place. False: kMost faults act already.
  bool inject(const ActiveFault& fault);
  // Clears faults of one part and returns their number. Without `kind` it clears all kinds, without `drive`
  // those of all drives.
  std::size_t clear(std::uint32_t part, std::optional<FaultKind> kind, std::optional<std::size_t> drive);
  void clear_all() { active_.clear(); }
  // Removes the faults that end at `tick` or before. True: there were some.
  bool expire(std::int64_t tick);
  // Time begins anew: every fault that has an end ends so many ticks sooner.
  void move_ends(std::int64_t ticks);
  // Parts have other numbers now: `now` gives the new one for each old one. Drops the faults of parts that
  // are kGone. The order of those that stay must stay.
  static constexpr std::uint32_t kGone = ~std::uint32_t{0};
  void renumber_parts(std::span<const std::uint32_t> now);

  // Sorted by part, then in the order of their injection.
  std::span<const ActiveFault> all() const { return active_; }
  std::span<const ActiveFault> of(std::uint32_t part) const;
  const ActiveFault* find(std::uint32_t part, FaultKind kind) const;

  void save(StateWriter& to) const;
  // Checks everything that it reads, and throws std::out_of_range. `parts`: the number of parts.
  void load(StateReader& from, std::size_t parts);

 private:
  std::vector<ActiveFault> active_;
};

}  // namespace visum::hwparts
