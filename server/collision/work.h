// Counts the work of colliding meshes, so that it can be limited by work and never by time: the same limit
// then gives the same contacts on every machine.
//
// One unit is one node of a mesh's tree that is looked at, 5 to 20 ns. Everything else is counted as the
// nodes that it is worth (narrow_phase.cc). Pairs without a mesh are not counted: their work has a bound of
// its own, since pairs that touch are limited by kMaxContacts, and pairs that do not touch are left alone
// until they have moved (travel.h).
#pragma once

#include <cstdint>

namespace visum::collision {

// The work of one pair. NarrowPhase owns it; tick's thread.
class PairWork {
 public:
  void start(std::uint64_t most) {
    most_ = most;
    taken_ = 0;
  }
  void take(std::uint64_t units) { taken_ += units; }
  bool is_spent() const { return taken_ >= most_; }
  std::uint64_t taken() const { return taken_; }

 private:
  std::uint64_t most_ = UINT64_MAX, taken_ = 0;
};

}  // namespace visum::collision
