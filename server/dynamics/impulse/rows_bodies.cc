// The rows within their bounds, where they hold free bodies only: solved for the bodies' velocities. Symbols
// as in body_factor.h.
#include <algorithm>
#include <cstring>

#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {

double Rows::softness(const Row& row) const {
  const RowBlock& block = blocks_[row.block];
  if (row.row == kAcross) return block.softness[1] + row.compliance;
  return block.softness[row.row] + (row.row == 0 ? block.compliance : 0.0);
}

bool Rows::bodies_alone() const {
  if (!std::ranges::all_of(active_softness_, [](double softness) { return softness > 0.0; })) return false;
  if (responses_.empty()) return true;
  return std::ranges::all_of(active_, [this](const Row& row) {
    const RowBlock& block = blocks_[row.block];
    return std::all_of(block.ends.begin(), block.ends.begin() + static_cast<std::ptrdiff_t>(block.end_count),
                       [](const RowEnd& end) { return end.free; });
  });
}

// It pushes along what it measures, and along the friction that it drags.
void Rows::direct(const Row& row, const RowEnd& end, double* measured, double* pushed) {
  std::array<double, 6> along;
  if (row.row == kAcross)
    for (std::size_t k = 0; k < 6; ++k) along[k] = row.across[0] * end.J[1][k] + row.across[1] * end.J[2][k];
  else
    along = end.J[row.row];
  std::memcpy(measured, along.data(), sizeof(along));
  std::memcpy(pushed, along.data(), sizeof(along));
  for (std::size_t i = 0; i < 2; ++i)
    if (row.drag[i] != 0.0)
      for (std::size_t k = 0; k < 6; ++k) pushed[k] += row.drag[i] * end.J[i + 1][k];
}

std::span<const Rows::Row> Rows::rows_of_block(std::size_t i) const {
  std::size_t end = i + 1;
  while (end < active_.size() && active_[end].block == active_[i].block) ++end;
  return std::span(active_).subspan(i, end - i);
}

void Rows::find_body_rows() {
  body_rows_.resize(active_.size());
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const RowBlock& block = blocks_[active_[i].block];
    BodyRow& row = body_rows_[i];
    row.softness = active_softness_[i];
    row.ends = block.end_count;
    for (std::size_t e = 0; e < block.end_count; ++e) {
      row.body[e] = block.ends[e].offset / 6;
      direct(active_[i], block.ends[e], row.measured[e], row.pushed[e]);
    }
  }
}

// All blocks count, whether their rows are active or not: so the bodies have one order in a moment.
void Rows::connect_bodies() {
  if (has_order_) return;
  // The search for an order looks at all bodies that are left, once for each.
  count_work(bodies_.size() * bodies_.size() / 2 / WorkBudget::kMultiplications);
  body_factor_.start(bodies_);
  for (const RowBlock& block : blocks_)
    if (block.end_count == 2 && block.ends[0].free && block.ends[1].free)
      body_factor_.connect(block.ends[0].offset / 6, block.ends[1].offset / 6);
  has_order_ = true;
}

bool Rows::factor_bodies(std::size_t most_entries) {
  // Without dragged friction the matrix is symmetric, and half of the work is saved.
  const bool symmetric = std::ranges::none_of(active_, &Row::drags);
  find_body_rows();
  connect_bodies();
  if (!body_factor_.place(symmetric, most_entries)) return false;
  count_work(body_factor_.multiplications() / WorkBudget::kMultiplications);
  for (std::size_t i = 0; i < active_.size();) {
    const std::size_t count = rows_of_block(i).size();
    body_factor_.add(std::span(body_rows_).subspan(i, count));
    i += count;
  }
  return body_factor_.factor();
}

}  // namespace visum::dynamics::impulse
