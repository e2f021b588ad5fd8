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

void BodyFactor::start(std::span<const FreeBody> bodies) {
  bodies_ = bodies;
  elimination_.start(bodies.size());
}

void BodyFactor::connect(std::size_t a, std::size_t b) {
  elimination_.connect(a, b);
}

bool BodyFactor::place(bool symmetric, std::size_t most_entries) {
  symmetric_ = symmetric;
  const std::size_t count = bodies_.size(), most_blocks = most_entries / 36;
  if (count > most_blocks || !elimination_.find(most_blocks - count)) return false;
  const std::size_t entries = elimination_.entries();
  diagonal_.resize(count);
  for (std::size_t k = 0; k < count; ++k) diagonal_[k] = mass_block(bodies_[elimination_.order()[k]]);
  inverse_.resize(count);
  lower_.assign(entries, Block{});
  upper_.resize(entries);
  if (!symmetric_) std::ranges::fill(upper_, Block{});
  return true;
}

double* BodyFactor::block(std::size_t a, std::size_t b) {
  const std::size_t row = elimination_.position(a), column = elimination_.position(b);
  if (row == column) return diagonal_[row].data();
  if (row > column) return lower_[elimination_.entry(row, column)].data();
  return symmetric_ ? nullptr : upper_[elimination_.entry(column, row)].data();
}

void BodyFactor::add(std::span<const BodyRow> rows) {
  std::array<double*, 4> blocks{};
  for (std::size_t a = 0; a < rows[0].ends; ++a)
    for (std::size_t b = 0; b < rows[0].ends; ++b)
      blocks[2 * a + b] = block(rows[0].body[a], rows[0].body[b]);
  kernels_->add_body_rows(rows.data(), rows.size(), blocks.data());
}

std::uint64_t BodyFactor::multiplications() const {
  return 216 * (elimination_.count() + elimination_.products(symmetric_));
}

bool BodyFactor::factor() {
  static_assert(sizeof(Block) == 36 * sizeof(double));
  if (diagonal_.empty()) return true;
  const auto numbers = [](std::vector<Block>& of) { return of.empty() ? nullptr : of.front().data(); };
  return kernels_->factor_blocks({.begins = elimination_.begins().data(),
                                  .rows = elimination_.rows().data(),
                                  .diagonal = numbers(diagonal_),
                                  .inverse = numbers(inverse_),
                                  .lower = numbers(lower_),
                                  .upper = numbers(upper_),
                                  .count = diagonal_.size(),
                                  .symmetric = symmetric_});
}

void BodyFactor::solve_bodies() {
  const std::span<const std::size_t> order = elimination_.order(), begins = elimination_.begins(),
                                     rows = elimination_.rows();
  const auto part = [&](std::size_t position) { return &steps_[6 * order[position]]; };
  // Forwards with L, then backwards with U and D^-1.
  for (std::size_t k = 0; k < order.size(); ++k)
    for (std::size_t e = begins[k]; e < begins[k + 1]; ++e) subtract(part(rows[e]), lower_[e], part(k));
  for (std::size_t k = order.size(); k-- > 0;) {
    double* const own = part(k);
    for (std::size_t e = begins[k]; e < begins[k + 1]; ++e) subtract(own, upper_[e], part(rows[e]));
    std::array<double, 6> x{};
    subtract(x.data(), inverse_[k], own);
    for (std::size_t i = 0; i < 6; ++i) own[i] = -x[i];
  }
}

// Right side: sum p r / s. Back to the rows: l = (r - j dv)/s.
void BodyFactor::solve(std::span<const BodyRow> rows, std::span<double> missing) {
  steps_.assign(6 * diagonal_.size(), 0.0);
  kernels_->push_by_body_rows(rows.data(), rows.size(), missing.data(), steps_.data());
  solve_bodies();
  kernels_->answer_body_rows(rows.data(), rows.size(), steps_.data(), missing.data());
}

}  // namespace visum::dynamics::impulse
