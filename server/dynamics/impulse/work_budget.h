// Counts the work of a tick, so that it can be limited by work and never by time: the same limit then gives
// the same bits on every machine, however busy it is.
//
// One unit is one row update at one of its bodies: the velocity along the row is found there, and an impulse
// is added. That takes 5 to 20 ns. Everything else whose length depends on the scene is counted as the row
// updates that it is worth:
//
//   a sweep over the rows        one unit for each row and body; on a mechanism, whose rows all answer each
//                                other, one more for kMultiplications rows there (Rows::prepare)
//   a factor of a matrix         its multiplications / kMultiplications (Rows, Mechanism): they stand in long
//                                loops, and are faster than those of a row
//   a pass over a mechanism      kPerNode for each body, and the rows of its loops (Mechanism::units)
//   building rows, free flight   kPerTouch for each contact, kPerBody for each body (Bounded, Stepper)
//
// Bits depend on these counts and on the limit: an answer that has cost much may be an inexact one
// (RowIsland). So what a solution counts depends on nothing but its island: not on the thread, nor on what a
// buffer has held before.
#pragma once

#include <cstddef>
#include <cstdint>

namespace visum::dynamics::impulse {

// Ends what would cost more than is left. ImpulseEngine catches it and makes the tick anew, limited.
struct WorkSpent {};

// The work of one tick of one engine. Plant owns it; tick's thread. Each other thread of the pool has one of
// its own, with all that is left here, and what it took is taken here afterwards (stepper.h). So the sum is
// compared with the limit at the end of a round.
class alignas(64) WorkBudget {
 public:
  static constexpr std::size_t kMultiplications = 32;  // in a unit
  static constexpr std::size_t kPerNode = 12, kPerTouch = 12, kPerBody = 4;

  // A tick begins, and may take so much.
  void start(std::uint64_t limit) { limit_ = left_ = limit; }
  // Asked before each piece of work, for all of it. Throws WorkSpent where that is more than is left.
  void take(std::uint64_t units) {
    if (units > left_) throw WorkSpent{};
    left_ -= units;
  }
  std::uint64_t limit() const { return limit_; }
  std::uint64_t left() const { return left_; }
  std::uint64_t taken() const { return limit_ - left_; }  // since start()

 private:
  std::uint64_t limit_ = UINT64_MAX, left_ = UINT64_MAX;
};

}  // namespace visum::dynamics::impulse
