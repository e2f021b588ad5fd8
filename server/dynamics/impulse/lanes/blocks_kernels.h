// Factors of matrices over rows and bodies (envelope_lu.h, body_factor.h). A block is 6 x 6 numbers by rows;
// each of its rows is worked on at once, four lanes and two. Every sum keeps one order, so that both builds
// give the same bits.
#pragma once

#include "server/dynamics/impulse/lanes/blocks_data.h"
#include "server/dynamics/impulse/lanes/six.h"

namespace visum::dynamics::impulse {
namespace {

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

// A step of Gauss-Jordan in place, with the pivot on the diagonal. Rows are read and written as a whole: a
// number that was stored alone would keep the next read of its row waiting.
template <int k>
VISUM_LANES_INLINE void eliminate(Six* rows) {
  const double inverse = 1.0 / lane<k>(rows[k]);
  const Six pivot = inverse * with_lane<k>(rows[k], 1.0);
  rows[k] = pivot;
  for (int i = 0; i < 6; ++i)
    if (i != k) rows[i] = with_lane<k>(rows[i], 0.0) - lane<k>(rows[i]) * pivot;
}

// Steps k to 5, with a pivot that is chosen before each. Returns false where there is none.
template <int k>
VISUM_LANES_INLINE bool eliminate_from(Six* rows, const auto& choose_pivot) {
  if constexpr (k < 6) {
    if (!choose_pivot(k, [rows](int i) { return lane<k>(rows[i]); })) return false;
    eliminate<k>(rows);
    return eliminate_from<k + 1>(rows, choose_pivot);
  }
  return true;
}

VISUM_LANES_INLINE void load_block(Six* rows, const double* from) {
  for (int i = 0; i < 6; ++i) rows[i] = load_six(from + 6 * i);
}
VISUM_LANES_INLINE void store_block(double* to, const Six* rows) {
  for (int i = 0; i < 6; ++i) store_six(to + 6 * i, rows[i]);
}

// Returns false where a pivot is not positive.
bool invert(double* to, const double* from) {
  Six rows[6];
  load_block(rows, from);
  if (!eliminate_from<0>(rows, [](int k, const auto& of) { return of(k) > 0.0; })) return false;
  store_block(to, rows);
  return true;
}

// The same with the largest pivot of each column. Returns false where there is none.
bool invert_with_pivots(double* to, const double* from) {
  Six rows[6];
  load_block(rows, from);
  int order[6] = {0, 1, 2, 3, 4, 5};
  const bool found = eliminate_from<0>(rows, [&](int k, const auto& of) {
    int best = k;
    for (int i = k + 1; i < 6; ++i)
      if (__builtin_fabs(of(i)) > __builtin_fabs(of(best))) best = i;
    const Six row = rows[k];
    rows[k] = rows[best];
    rows[best] = row;
    const int number = order[k];
    order[k] = order[best];
    order[best] = number;
    return __builtin_fabs(of(k)) > 0.0;
  });
  if (!found) return false;
  // Exchanged rows of the matrix are exchanged columns of the inverse.
  double mixed[36];
  store_block(mixed, rows);
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i) to[6 * i + order[k]] = mixed[6 * i + k];
  return true;
}

// c_ab += sum p_a j_b^T / s over up to three rows on the same bodies, where c_ab is the block 2 a + b. Blocks
// that are null are left out.
void add_body_rows(const BodyRow* rows, std::size_t count, double* const* blocks) {
  double grip[3] = {};
  for (std::size_t r = 0; r < count; ++r) grip[r] = 1.0 / rows[r].softness;
  for (std::size_t b = 0; b < rows->ends; ++b) {
    Six j[3];
    for (std::size_t r = 0; r < count; ++r) j[r] = load_six(rows[r].measured[b]);
    for (std::size_t a = 0; a < rows->ends; ++a) {
      double* const c = blocks[2 * a + b];
      if (c == nullptr) continue;
      for (std::size_t i = 0; i < 6; ++i) {
        Six sum = (rows[0].pushed[a][i] * grip[0]) * j[0];
        for (std::size_t r = 1; r < count; ++r) sum = sum + (rows[r].pushed[a][i] * grip[r]) * j[r];
        store_six(c + 6 * i, load_six(c + 6 * i) + sum);
      }
    }
  }
}

// to += sum p r / s
void push_by_body_rows(const BodyRow* rows, std::size_t count, const double* missing, double* to) {
  for (const BodyRow* row = rows; row != rows + count; ++row) {
    const double impulse = missing[row - rows] / row->softness;
    for (std::size_t e = 0; e < row->ends; ++e) {
      double* const body = to + 6 * row->body[e];
      store_six(body, load_six(body) + impulse * load_six(row->pushed[e]));
    }
  }
}

// r := (r - j v)/s
void answer_body_rows(const BodyRow* rows, std::size_t count, const double* v, double* missing) {
  for (const BodyRow* row = rows; row != rows + count; ++row) {
    double left = missing[row - rows];
    for (std::size_t e = 0; e < row->ends; ++e) {
      const double *const j = row->measured[e], *const x = v + 6 * row->body[e];
      left -= j[0] * x[0] + j[1] * x[1] + j[2] * x[2] + j[3] * x[3] + j[4] * x[4] + j[5] * x[5];
    }
    missing[row - rows] = left / row->softness;
  }
}

// The inverse of a block on the diagonal; false where there is none. Friction that is dragged along may make
// single pivots of a sound block negative or zero; then rows are exchanged.
bool invert_diagonal(double* to, const double* from, bool symmetric) {
  return invert(to, from) || (!symmetric && invert_with_pivots(to, from));
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
