// Factors of matrices over rows and bodies (envelope_lu.h, body_factor.h). A block is 6 x 6 numbers by rows;
// each of its rows is worked on at once, four lanes and two. Every sum keeps one order, so that both builds
// give the same bits.
#pragma once

#include "server/dynamics/impulse/lanes/lanes.h"

namespace visum::dynamics::impulse {
namespace {

// A row of a block.
struct Six {
  Lanes four;
  Pair two;
};

VISUM_LANES_INLINE Six load_six(const double* from) {
  return {load(from), load_pair(from + 4)};
}
VISUM_LANES_INLINE void store_six(double* to, Six from) {
  store(to, from.four);
  store_pair(to + 4, from.two);
}
VISUM_LANES_INLINE Six operator+(Six a, Six b) {
  return {a.four + b.four, a.two + b.two};
}
VISUM_LANES_INLINE Six operator-(Six a, Six b) {
  return {a.four - b.four, a.two - b.two};
}
VISUM_LANES_INLINE Six operator*(double a, Six b) {
  return {all(a) * b.four, Pair{a, a} * b.two};
}

// c -= a b
VISUM_LANES_INLINE void subtract_product(double* c, const double* a, const double* b) {
  const Six b0 = load_six(b), b1 = load_six(b + 6), b2 = load_six(b + 12), b3 = load_six(b + 18),
            b4 = load_six(b + 24), b5 = load_six(b + 30);
  for (int i = 0; i < 36; i += 6) {
    const double* const x = a + i;
    store_six(c + i, load_six(c + i) -
                         (((x[0] * b0 + x[1] * b1) + (x[2] * b2 + x[3] * b3)) + (x[4] * b4 + x[5] * b5)));
  }
}

// a := a b
VISUM_LANES_INLINE void multiply(double* a, const double* b) {
  for (int i = 0; i < 36; i += 6) {
    Six sum = a[i] * load_six(b);
    for (int k = 1; k < 6; ++k) sum = sum + a[i + k] * load_six(b + 6 * k);
    store_six(a + i, sum);
  }
}

// A step of Gauss-Jordan in place, with the pivot on the diagonal.
VISUM_LANES_INLINE void eliminate(double* a, int k) {
  const double inverse = 1.0 / a[7 * k];
  a[7 * k] = 1.0;
  const Six pivot = inverse * load_six(a + 6 * k);
  store_six(a + 6 * k, pivot);
  for (int i = 0; i < 6; ++i) {
    if (i == k) continue;
    const double factor = a[6 * i + k];
    a[6 * i + k] = 0.0;
    store_six(a + 6 * i, load_six(a + 6 * i) - factor * pivot);
  }
}

// Returns false where a pivot is not positive.
bool invert(double* a) {
  for (int k = 0; k < 6; ++k) {
    if (!(a[7 * k] > 0.0)) return false;
    eliminate(a, k);
  }
  return true;
}

// The same with the largest pivot of each column. Returns false where there is none.
bool invert_with_pivots(double* a) {
  int order[6] = {0, 1, 2, 3, 4, 5};
  for (int k = 0; k < 6; ++k) {
    int best = k;
    for (int i = k + 1; i < 6; ++i)
      if (__builtin_fabs(a[6 * i + k]) > __builtin_fabs(a[6 * best + k])) best = i;
    if (best != k) {
      const Six row = load_six(a + 6 * k);
      store_six(a + 6 * k, load_six(a + 6 * best));
      store_six(a + 6 * best, row);
      const int number = order[k];
      order[k] = order[best];
      order[best] = number;
    }
    if (!(__builtin_fabs(a[7 * k]) > 0.0)) return false;
    eliminate(a, k);
  }
  // Exchanged rows of the matrix are exchanged columns of the inverse.
  double mixed[36];
  __builtin_memcpy(mixed, a, sizeof(mixed));
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i) a[6 * i + order[k]] = mixed[6 * i + k];
  return true;
}

// c += sum x y^T over `count` rows of six.
void add_products(double* c, const double* x, const double* y, std::size_t count) {
  for (int i = 0; i < 6; ++i) {
    Six sum = x[i] * load_six(y);
    for (std::size_t r = 1; r < count; ++r) sum = sum + x[6 * r + i] * load_six(y + 6 * r);
    store_six(c + 6 * i, load_six(c + 6 * i) + sum);
  }
}

// The inverse of a block on the diagonal; false where there is none. Friction that is dragged along may make
// single pivots of a sound block negative or zero; then rows are exchanged.
bool invert_diagonal(double* to, const double* from, bool symmetric) {
  __builtin_memcpy(to, from, 36 * sizeof(double));
  if (invert(to)) return true;
  if (symmetric) return false;
  __builtin_memcpy(to, from, 36 * sizeof(double));
  return invert_with_pivots(to);
}

// Column after column: L_ik = A_ik D_k^-1, then A_ij -= L_ik U_kj for each two blocks of the column
// (body_factor.h). Their target is in the column of the earlier one, where the rows of this one stand, too.
bool factor_blocks(BlockMatrix of) {
  for (std::size_t k = 0; k < of.count; ++k) {
    double* const inverse = of.inverse + 36 * k;
    if (!invert_diagonal(inverse, of.diagonal + 36 * k, of.symmetric)) return false;
    const std::size_t begin = of.begins[k], end = of.begins[k + 1];
    for (std::size_t e = begin; e < end; ++e) {
      double *const low = of.lower + 36 * e, *const up = of.upper + 36 * e;
      if (of.symmetric)
        for (int r = 0; r < 6; ++r)
          for (int c = 0; c < 6; ++c) up[6 * c + r] = low[6 * r + c];
      multiply(low, inverse);
    }
    for (std::size_t e = begin; e < end; ++e) {
      const std::size_t j = of.rows[e];
      subtract_product(of.diagonal + 36 * j, of.lower + 36 * e, of.upper + 36 * e);
      std::size_t at = of.begins[j];
      for (std::size_t f = e + 1; f < end; ++f, ++at) {
        while (of.rows[at] != of.rows[f]) ++at;
        subtract_product(of.lower + 36 * at, of.lower + 36 * f, of.upper + 36 * e);
        if (!of.symmetric) subtract_product(of.upper + 36 * at, of.lower + 36 * e, of.upper + 36 * f);
      }
    }
  }
  return true;
}

// A dot product of the entries from..to-1, in four sums of fixed order.
VISUM_LANES_INLINE double dot_of_rows(const double* a, const double* b, std::size_t from, std::size_t to) {
  Lanes sums = all(0.0);
  std::size_t k = from;
  for (; k + 4 <= to; k += 4) sums = sums + load(a + k) * load(b + k);
  double sum[4];
  store(sum, sums);
  for (; k < to; ++k) sum[0] += a[k] * b[k];
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

// l_ij = (a_ij - sum l_ik u_kj) / u_jj,  u_ji = a_ji - sum l_jk u_ki (envelope_lu.h).
bool factor_envelope(EnvelopeMatrix of) {
  const auto at = [&](double* entries, std::size_t i) { return entries + of.start[i] - of.first[i]; };
  for (std::size_t i = of.begin; i < of.count; ++i) {
    double *const ri = at(of.lower, i), *const ci = at(of.upper, i);
    for (std::size_t j = of.first[i]; j < i; ++j) {
      const std::size_t from = of.first[i] > of.first[j] ? of.first[i] : of.first[j];
      ri[j] = (ri[j] - dot_of_rows(ri, at(of.upper, j), from, j)) * of.inverse_diagonal[j];
      ci[j] -= dot_of_rows(ci, at(of.lower, j), from, j);
    }
    const double pivot = ri[i] - dot_of_rows(ri, ci, of.first[i], i);
    if (!(pivot > 0.0)) return false;
    of.inverse_diagonal[i] = 1.0 / pivot;
  }
  return true;
}

}  // namespace
}  // namespace visum::dynamics::impulse
