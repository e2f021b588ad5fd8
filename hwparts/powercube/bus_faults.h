// The faults on purpose (hwparts/fault_kinds.h) of a bus: shares of the frames, from 0 to 1, and a delay.
// Plain values.
#pragma once

#include <cstdint>

namespace visum::powercube {

struct BusFaults {
  double lost = 0.0, doubled = 0.0, corrupted = 0.0;
  std::int64_t late_ns = 0;
  bool by_chance() const { return lost > 0.0 || doubled > 0.0 || corrupted > 0.0; }
  bool operator==(const BusFaults&) const = default;
};

// The faults that one frame of a module meets on its way.
struct Passage {
  bool lost = false, doubled = false, corrupted = false;
  std::int64_t late_ns = 0;
};

}  // namespace visum::powercube
