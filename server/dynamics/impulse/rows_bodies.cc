// The rows within their bounds, where they hold free bodies only: solved for the bodies' velocities. Symbols
// as in body_factor.h.
#include <algorithm>

#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

// Velocity along a direction.
double along(const BodyFactor::Vector6& a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

}  // namespace

double Rows::softness(const Row& row) const {
  const RowBlock& block = blocks_[row.block];
  if (row.row == kAcross) return block.softness[1] + row.compliance;
  return block.softness[row.row] + (row.row == 0 ? block.compliance : 0.0);
}

bool Rows::bodies_alone() const {
  return std::all_of(active_.begin(), active_.end(), [this](const Row& row) {
    const RowBlock& block = blocks_[row.block];
    return std::all_of(block.ends.begin(), block.ends.begin() + static_cast<std::ptrdiff_t>(block.end_count),
                       [](const RowEnd& end) { return end.free; }) &&
           softness(row) > 0.0;
  });
}

BodyFactor::Vector6 Rows::measure(const Row& row, const RowEnd& end) {
  if (row.row != kAcross) return end.J[row.row];
  BodyFactor::Vector6 along;
  for (std::size_t k = 0; k < 6; ++k) along[k] = row.across[0] * end.J[1][k] + row.across[1] * end.J[2][k];
  return along;
}

// Unit impulse on the row, with the friction that it drags along.
BodyFactor::Vector6 Rows::push(const Row& row, const RowEnd& end) const {
  BodyFactor::Vector6 push = measure(row, end);
  for (std::size_t i = 0; i < 2; ++i)
    if (row.drag[i] != 0.0)
      for (std::size_t k = 0; k < 6; ++k) push[k] += row.drag[i] * end.J[i + 1][k];
  return push;
}

std::span<const Rows::Row> Rows::rows_of_block(std::size_t i) const {
  std::size_t end = i + 1;
  while (end < active_.size() && active_[end].block == active_[i].block) ++end;
  return std::span(active_).subspan(i, end - i);
}

void Rows::add_to_bodies(std::span<const Row> rows) {
  // Each row adds  p j^T / s  to the blocks of its one or two bodies.
  const RowBlock& block = blocks_[rows[0].block];
  std::array<std::array<BodyFactor::Vector6, 3>, 2> pushed, measured;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double grip = 1.0 / softness(rows[r]);
    for (std::size_t e = 0; e < block.end_count; ++e) {
      measured[e][r] = measure(rows[r], block.ends[e]);
      pushed[e][r] = push(rows[r], block.ends[e]);
      for (double& entry : pushed[e][r]) entry *= grip;
    }
  }
  for (std::size_t a = 0; a < block.end_count; ++a)
    for (std::size_t b = 0; b < block.end_count; ++b)
      body_factor_.add(block.ends[a].offset / 6, std::span(pushed[a]).first(rows.size()),
                       block.ends[b].offset / 6, std::span(measured[b]).first(rows.size()));
}

bool Rows::factor_bodies(std::size_t most_entries) {
  // Without dragged friction the matrix is symmetric, and half of the work is saved.
  const bool symmetric = std::none_of(active_.begin(), active_.end(), [](const Row& row) {
    return row.drag[0] != 0.0 || row.drag[1] != 0.0;
  });
  body_factor_.start(bodies_, symmetric);
  for (const Row& row : active_)
    if (const RowBlock& block = blocks_[row.block]; block.end_count == 2)
      body_factor_.connect(block.ends[0].offset / 6, block.ends[1].offset / 6);
  // The search for an order looks at all bodies that are left, once for each.
  count_factor(bodies_.size() * bodies_.size() / 2 / WorkBudget::kMultiplications);
  if (!body_factor_.place(most_entries)) return false;
  count_factor(body_factor_.multiplications() / WorkBudget::kMultiplications);
  for (std::size_t i = 0; i < active_.size();) {
    const std::span<const Row> rows = rows_of_block(i);
    add_to_bodies(rows);
    i += rows.size();
  }
  return body_factor_.factor();
}

void Rows::solve_bodies() {
  // Right side: sum p r / s.
  body_steps_.assign(6 * bodies_.size(), 0.0);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const RowBlock& block = blocks_[active_[i].block];
    const double impulse = missing_[i] / softness(active_[i]);
    for (std::size_t e = 0; e < block.end_count; ++e) {
      const BodyFactor::Vector6 pushed = push(active_[i], block.ends[e]);
      for (std::size_t k = 0; k < 6; ++k) body_steps_[block.ends[e].offset + k] += impulse * pushed[k];
    }
  }
  body_factor_.solve(body_steps_);
  // Back to the rows: l = (r - j dv)/s.
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const RowBlock& block = blocks_[active_[i].block];
    double left = missing_[i];
    for (std::size_t e = 0; e < block.end_count; ++e)
      left -= along(measure(active_[i], block.ends[e]), &body_steps_[block.ends[e].offset]);
    missing_[i] = left / softness(active_[i]);
  }
}

}  // namespace visum::dynamics::impulse
