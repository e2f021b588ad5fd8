// The system of a few rows that all act on each other (small_system.h), column by column.
#pragma once

#include "server/dynamics/impulse/lanes/lanes.h"
#include "server/dynamics/impulse/lanes/small_data.h"

namespace visum::dynamics::impulse {
namespace {

// A column: what a row's impulse does to every row. The responses are symmetric, so it is made of their rows.
// `sum` has room for one of them.
VISUM_LANES_INLINE void fill_column(const SmallMatrix& of, std::size_t k, double* sum) {
  const SmallRow& by = of.rows[k];
  const double* does = of.responses + by.at * of.stride;
  if (by.kind != SmallRow::Kind::kPlain) {
    const bool drags = by.kind == SmallRow::Kind::kDrags;
    const double *const first = drags ? does + of.stride : does, *const second = first + of.stride;
    for (std::size_t i = 0; i < of.stride; i += 4) {
      const Lanes friction = all(by.along[0]) * load(first + i) + all(by.along[1]) * load(second + i);
      store(sum + i, drags ? load(does + i) + friction : friction);
    }
    does = sum;
  }
  double* const to = of.upper + k * of.height;
  for (std::size_t i = 0; i < of.count; ++i) {
    const SmallRow& row = of.rows[i];
    const double* const at = does + row.at;
    to[i] = row.kind == SmallRow::Kind::kAcross ? row.along[0] * at[0] + row.along[1] * at[1] : at[0];
  }
  for (std::size_t i = of.count; i < of.height; ++i) to[i] = 0.0;
  to[k] += by.softness;
}

// L and U without exchanges: with the pivot p of column k, l_ik = a_ik / p, then a_ij -= l_ik a_kj for the
// columns behind. Whole lanes are worked on; those that are not meant have l = 0. Returns false where a pivot
// is not positive.
bool factor_small(SmallMatrix of, double* sum) {
  for (std::size_t k = 0; k < of.count; ++k) fill_column(of, k, sum);
  static constexpr double kBelow[7] = {0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0};
  for (std::size_t k = 0; k < of.count; ++k) {
    const double* const column = of.upper + k * of.height;
    double* const low = of.lower + k * of.height;
    const double pivot = column[k];
    if (!(pivot > 0.0)) return false;
    of.inverse[k] = 1.0 / pivot;
    const Lanes inverse = all(of.inverse[k]);
    const std::size_t begin = k & ~std::size_t{3};
    for (std::size_t i = 0; i < begin; i += 4) store(low + i, all(0.0));
    store(low + begin, load(column + begin) * load(kBelow + 3 - (k - begin)) * inverse);
    for (std::size_t i = begin + 4; i < of.height; i += 4) store(low + i, load(column + i) * inverse);
    for (std::size_t j = k + 1; j < of.count; ++j) {
      double* const to = of.upper + j * of.height;
      const Lanes times = all(to[k]);
      for (std::size_t i = begin; i < of.height; i += 4) store(to + i, load(to + i) - load(low + i) * times);
    }
  }
  return true;
}

// b := the solution.
void solve_small(SmallMatrix of, double* b, double* left) {
  for (std::size_t i = 0; i < of.height; ++i) left[i] = i < of.count ? b[i] : 0.0;
  for (std::size_t k = 0; k < of.count; ++k) {
    const double* const low = of.lower + k * of.height;
    const Lanes times = all(left[k]);
    for (std::size_t i = k & ~std::size_t{3}; i < of.height; i += 4)
      store(left + i, load(left + i) - load(low + i) * times);
  }
  for (std::size_t k = of.count; k-- > 0;) {
    const double* const up = of.upper + k * of.height;
    const Lanes times = all(left[k]), inverse = all(of.inverse[k]);
    b[k] = left[k] * of.inverse[k];
    for (std::size_t i = 0; i <= k; i += 4) store(left + i, load(left + i) - load(up + i) * inverse * times);
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
