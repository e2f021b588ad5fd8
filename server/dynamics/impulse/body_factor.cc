#include "server/dynamics/impulse/body_factor.h"

#include <algorithm>

namespace visum::dynamics::impulse {
namespace {

using Block = std::array<double, 36>;

// b -= a x
void subtract(double* b, const Block& a, const double* x) {
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) b[i] -= a[6 * i + j] * x[j];
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
  // The upper half is not needed where the matrix is symmetric.
  const bool below = b <= a;
  if (!below && symmetric_) return;
  Block& block = below ? row(a, b) : column(b, a);
  kernels_->add_products(block.data(), push[0].data(), measure[0].data(), push.size());
}

// Products of two blocks: one for each k in factor_blocks(), twice as many where the upper half is made, too;
// and one for each block below the diagonal.
std::uint64_t BodyFactor::multiplications() const {
  std::uint64_t products = 0;
  for (std::size_t i = 0; i < first_.size(); ++i)
    for (std::size_t j = first_[i]; j <= i; ++j)
      products += (symmetric_ ? 1 : 2) * (j - std::max(first_[i], first_[j])) + 1;
  return 216 * products;
}

bool BodyFactor::factor() {
  static_assert(sizeof(Block) == 36 * sizeof(double));
  if (first_.empty()) return true;
  return kernels_->factor_blocks({.first = first_.data(),
                                  .start = start_.data(),
                                  .lower = lower_.data()->data(),
                                  .upper = upper_.data()->data(),
                                  .inverse = inverse_.data()->data(),
                                  .count = first_.size(),
                                  .symmetric = symmetric_});
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
      subtract(&b[6 * j], upper_[start_[i] + j - first_[i]], &b[6 * i]);
  }
}

}  // namespace visum::dynamics::impulse
