#include "server/dynamics/impulse/body_factor.h"

#include <algorithm>
#include <cmath>

namespace visum::dynamics::impulse {
namespace {

using Block = std::array<double, 36>;

// c -= a b^T. The order of the sums is written out, so every compiler gives the same bits.
void subtract_product(Block& c, const Block& a, const Block& b) {
  for (std::size_t i = 0; i < 36; i += 6)
    for (std::size_t j = 0; j < 6; ++j) {
      const double *const x = &a[i], *const y = &b[6 * j];
      c[i + j] -= ((x[0] * y[0] + x[1] * y[1]) + (x[2] * y[2] + x[3] * y[3])) + (x[4] * y[4] + x[5] * y[5]);
    }
}

// a b, with blocks by rows.
Block product(const Block& a, const Block& b) {
  Block c{};
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t j = 0; j < 6; ++j) c[6 * i + j] += a[6 * i + k] * b[6 * k + j];
  return c;
}

// A step of Gauss-Jordan in place, with the pivot on the diagonal.
void eliminate(Block& a, std::size_t k) {
  const double inverse = 1.0 / a[7 * k];
  a[7 * k] = 1.0;
  for (std::size_t j = 0; j < 6; ++j) a[6 * k + j] *= inverse;
  for (std::size_t i = 0; i < 6; ++i) {
    if (i == k) continue;
    const double factor = a[6 * i + k];
    a[6 * i + k] = 0.0;
    for (std::size_t j = 0; j < 6; ++j) a[6 * i + j] -= factor * a[6 * k + j];
  }
}

// Returns false where a pivot is not positive.
bool invert(Block& a) {
  for (std::size_t k = 0; k < 6; ++k) {
    if (!(a[7 * k] > 0.0)) return false;
    eliminate(a, k);
  }
  return true;
}

// The same with the largest pivot of each column. Returns false where there is none.
bool invert_with_pivots(Block& a) {
  std::array<std::size_t, 6> order{0, 1, 2, 3, 4, 5};
  for (std::size_t k = 0; k < 6; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < 6; ++i)
      if (std::abs(a[6 * i + k]) > std::abs(a[6 * best + k])) best = i;
    if (best != k) {
      std::swap_ranges(&a[6 * k], &a[6 * k] + 6, &a[6 * best]);
      std::swap(order[k], order[best]);
    }
    if (!(std::abs(a[7 * k]) > 0.0)) return false;
    eliminate(a, k);
  }
  // Exchanged rows of the matrix are exchanged columns of the inverse.
  const Block mixed = a;
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t i = 0; i < 6; ++i) a[6 * i + order[k]] = mixed[6 * i + k];
  return true;
}

// b -= a x, and b -= a^T x.
void subtract(double* b, const Block& a, const double* x) {
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) b[i] -= a[6 * i + j] * x[j];
}

void subtract_transposed(double* b, const Block& a, const double* x) {
  for (std::size_t j = 0; j < 6; ++j)
    for (std::size_t i = 0; i < 6; ++i) b[i] -= a[6 * j + i] * x[j];
}

Block mass_block(const FreeBody& body) {
  Block block{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) block[6 * i + j] = body.inertia[3 * i + j];
    block[7 * (i + 3)] = body.mass;
  }
  return block;
}

}  // namespace

void BodyFactor::start(std::span<const FreeBody> bodies, bool symmetric) {
  // Before any row connects bodies, the pattern is the diagonal.
  bodies_ = bodies;
  symmetric_ = symmetric;
  first_.resize(bodies.size());
  start_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) first_[i] = i;
}

void BodyFactor::connect(std::size_t a, std::size_t b) {
  const auto [low, high] = std::minmax(a, b);
  first_[high] = std::min(first_[high], low);
}

bool BodyFactor::place(std::size_t most_entries) {
  std::size_t blocks = 0;
  for (std::size_t i = 0; i < first_.size(); ++i) {
    start_[i] = blocks;
    blocks += i - first_[i] + 1;
  }
  if (36 * blocks > most_entries) return false;
  lower_.assign(blocks, Block{});
  upper_.resize(blocks);
  if (!symmetric_) std::fill(upper_.begin(), upper_.end(), Block{});
  inverse_.resize(first_.size());
  for (std::size_t i = 0; i < first_.size(); ++i) row(i, i) = mass_block(bodies_[i]);
  return true;
}

void BodyFactor::add(std::size_t a, std::span<const Vector6> push, std::size_t b,
                     std::span<const Vector6> measure) {
  // Below the diagonal the block is stored by rows, above it transposed. The upper half is not needed where
  // the matrix is symmetric.
  const bool below = b <= a;
  if (!below && symmetric_) return;
  Block& block = below ? row(a, b) : column(b, a);
  const std::span<const Vector6> x = below ? push : measure, y = below ? measure : push;
  for (std::size_t i = 0; i < 6; ++i) {
    Vector6 sum{};
    for (std::size_t r = 0; r < x.size(); ++r)
      for (std::size_t j = 0; j < 6; ++j) sum[j] += x[r][i] * y[r][j];
    for (std::size_t j = 0; j < 6; ++j) block[6 * i + j] += sum[j];
  }
}

// Products of two blocks: one for each k in eliminate(), twice as many where the upper half is made, too; and
// one for each block below the diagonal.
std::uint64_t BodyFactor::multiplications() const {
  std::uint64_t products = 0;
  for (std::size_t i = 0; i < first_.size(); ++i)
    for (std::size_t j = first_[i]; j <= i; ++j)
      products += (symmetric_ ? 1 : 2) * (j - std::max(first_[i], first_[j])) + 1;
  return 216 * products;
}

// The same formulas as for single numbers (envelope_lu.cc): L_ij = (A_ij - sum L_ik U_kj) D_j^-1 and U_ji =
// A_ji - sum L_jk U_ki.
void BodyFactor::eliminate(std::size_t i, std::size_t j) {
  for (std::size_t k = std::max(first_[i], first_[j]); k < j; ++k) {
    subtract_product(row(i, j), row(i, k), column(j, k));
    if (i != j && !symmetric_) subtract_product(column(i, j), column(i, k), row(j, k));
  }
}

bool BodyFactor::factor() {
  for (std::size_t i = 0; i < first_.size(); ++i) {
    for (std::size_t j = first_[i]; j < i; ++j) {
      eliminate(i, j);
      if (symmetric_) column(i, j) = row(i, j);
      row(i, j) = product(row(i, j), inverse_[j]);
    }
    eliminate(i, i);
    inverse_[i] = row(i, i);
    if (invert(inverse_[i])) continue;
    // Friction that is dragged along may make single pivots negative or zero; the block is sound
    // nevertheless.
    inverse_[i] = row(i, i);
    if (symmetric_ || !invert_with_pivots(inverse_[i])) return false;
  }
  return true;
}

void BodyFactor::solve(std::vector<double>& b) const {
  // Forwards with L, then backwards with D^-1 and U.
  for (std::size_t i = 0; i < first_.size(); ++i)
    for (std::size_t j = first_[i]; j < i; ++j)
      subtract(&b[6 * i], lower_[start_[i] + j - first_[i]], &b[6 * j]);
  for (std::size_t i = first_.size(); i-- > 0;) {
    Vector6 x{};
    subtract(x.data(), inverse_[i], &b[6 * i]);
    for (std::size_t k = 0; k < 6; ++k) b[6 * i + k] = -x[k];
    for (std::size_t j = first_[i]; j < i; ++j)
      subtract_transposed(&b[6 * j], upper_[start_[i] + j - first_[i]], &b[6 * i]);
  }
}

}  // namespace visum::dynamics::impulse
