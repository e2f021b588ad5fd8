// The matrices and rows of body_factor.h and envelope_lu.h, as kernels see them.
#pragma once

#include <cstddef>

namespace visum::dynamics::impulse {

// By columns, of which only the blocks below the diagonal that are not zero are stored.
struct BlockMatrix {
  const std::size_t* begins;   // by column: where its blocks begin; one more at the end
  const std::size_t* rows;     // by block: its row
  double *diagonal, *inverse;  // blocks of 6 x 6, by column; inverse: of the blocks on the diagonal
  double *lower, *upper;       // by block; upper: that of the transposed place
  std::size_t count;           // of columns
  bool symmetric;              // `upper` follows from `lower`
};

// A row on one or two bodies: what it measures and how it pushes there, six numbers each (angular, linear).
struct BodyRow {
  double softness;
  std::size_t ends, body[2];
  double measured[2][6], pushed[2][6];
};

// Each row is stored from its first entry that is not zero, each column likewise.
struct EnvelopeMatrix {
  const std::size_t *first, *start;
  double *lower, *upper, *inverse_diagonal;
  std::size_t begin, count;  // the rows before `begin` are factored already
};

}  // namespace visum::dynamics::impulse
