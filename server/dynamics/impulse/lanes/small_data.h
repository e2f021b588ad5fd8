// The matrix and rows of small_system.h, as kernels see them.
#pragma once

#include <cstddef>

namespace visum::dynamics::impulse {

// A row that takes part. `at` is its place among all rows; of one across the sliding, that of the first
// tangent.
struct SmallRow {
  enum class Kind { kPlain, kDrags, kAcross };
  std::size_t at;
  Kind kind;
  // kDrags: friction that follows the impulse, on the rows at + 1 and at + 2. kAcross: its direction, of the
  // rows at and at + 1.
  double along[2];
  double softness;  // is added on the diagonal
};

// Columns are `height` numbers apart, a multiple of four, at least `count`.
struct SmallMatrix {
  const double* responses;  // of all rows to each other, symmetric; each row `stride` numbers
  std::size_t stride;       // a multiple of four
  const SmallRow* rows;
  std::size_t count, height;
  double* upper;    // U above the diagonal
  double* lower;    // L below it, which is 1 there; zero elsewhere
  double* inverse;  // of the pivots
};

}  // namespace visum::dynamics::impulse
