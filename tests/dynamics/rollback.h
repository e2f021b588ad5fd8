// Checks that a restored world goes on with the same bits: at each tick back by seven ticks, and forward
// again.
#pragma once

#include <optional>
#include <vector>

#include "tests/dynamics/lab.h"

namespace visum::dynamics::testing {

// Two labs of the same world; the second is rolled back. Returns the first of `ticks` ticks whose hash
// differs, or nothing.
inline std::optional<int> first_difference_when_rolled_back(Lab& straight, Lab& rolled, int ticks) {
  constexpr std::size_t kBack = 7;
  std::vector<world::WorldState> history;
  for (int i = 0; i < ticks; ++i) {
    history.push_back(rolled.state);
    rolled.run_ticks(1);
    straight.run_ticks(1);
    if (history.size() < kBack) continue;
    rolled.state = history[history.size() - kBack];
    rolled.run_ticks(kBack);
    if (straight.hash() != rolled.hash()) return i;
  }
  return std::nullopt;
}

}  // namespace visum::dynamics::testing
