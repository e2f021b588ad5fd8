// The matrices of body_factor.h and envelope_lu.h, as kernels see them. Each row is stored from its first
// entry (or block) that is not zero, each column likewise.
#pragma once

#include <cstddef>

namespace visum::dynamics::impulse {

struct BlockMatrix {
  const std::size_t *first, *start;  // by row: its first column, and where it begins in `lower` and `upper`
  double *lower, *upper, *inverse;   // blocks of 6 x 6, by rows; inverse: of the blocks on the diagonal
  std::size_t count;                 // of rows
  bool symmetric;                    // `upper` follows from `lower`
};

struct EnvelopeMatrix {
  const std::size_t *first, *start;
  double *lower, *upper, *inverse_diagonal;
  std::size_t begin, count;  // the rows before `begin` are factored already
};

}  // namespace visum::dynamics::impulse
