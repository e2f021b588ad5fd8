// The rows that are within their bounds, solved at once: the subspace step of Silcowitz-Hansen, Niebe,
// Erleben, Projected Gauss-Seidel subspace minimization method for interactive rigid body dynamics, GRAPP
// 2010. Sweeps find out which rows those are; the step finds their impulses, whatever the ratio of masses is.
//
// Symbols: A response of the rows that are free to each other, S softness and compliance, r what they miss.
//   (A + S) dl = r, as far as the first bound
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/friction_cone.h"
#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostRefinements = 2;
constexpr int kMostSteps = 8;                  // from bound to bound
constexpr std::size_t kMostEntries = 400'000;  // of the factor: beyond, sweeps alone are quicker
constexpr double kInside = 1.0 - 1e-9;         // share of the friction's radius up to which a contact sticks

double dot(const std::array<double, 6>& a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

bool meet(const RowEnd& a, const RowEnd& b) {
  return a.free == b.free && a.offset == b.offset;
}

bool meet(const RowBlock& a, const RowBlock& b) {
  for (std::size_t i = 0; i < a.end_count; ++i)
    for (std::size_t j = 0; j < b.end_count; ++j)
      if (meet(a.ends[i], b.ends[j])) return true;
  return false;
}

}  // namespace

// What an impulse on row s of b does to row r of a, and the other way round.
double Rows::response(const RowBlock& a, std::size_t r, const RowBlock& b, std::size_t s) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.end_count; ++i) {
    for (std::size_t j = 0; j < b.end_count; ++j) {
      const RowEnd &end_a = a.ends[i], &end_b = b.ends[j];
      if (!meet(end_a, end_b)) continue;
      sum += end_a.free ? dot(end_a.J[r], end_b.MJ[s].data())
                        : responses[end_a.response + (end_a.first + r) * end_a.size + end_b.first + s];
    }
  }
  return sum;
}

// What b's friction does to row a, where it is dragged along.
double Rows::dragged(const Row& a, const Row& b) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < 2; ++i)
    if (b.drag[i] != 0.0) sum += b.drag[i] * response(blocks[a.block], a.row, blocks[b.block], i + 1);
  return sum;
}

// What slides takes part with its normal, and with its tangents again where it is asked to slide less.
void Rows::add_contact(std::size_t index) {
  RowBlock& block = blocks[index];
  if (block.K[0][0] <= kRigid * block.free_response || !(block.lambda[0] > block.low)) return;
  const double radius = block.friction * pressure(block);
  const Tangential held{block.lambda[1] + block.base[1], block.lambda[2] + block.base[2]};
  const bool slides = radius == 0.0 || (!is_within_disc(held, kInside * radius) &&
                                        held[0] * error(block, 1) + held[1] * error(block, 2) >= 0.0);
  Row normal{index, 0};
  block.drags = slides && radius > 0.0;
  if (block.drags) normal.drag = {block.friction * held[0] / radius, block.friction * held[1] / radius};
  active_.push_back(normal);
  if (slides) return;
  active_.push_back({index, 1});
  active_.push_back({index, 2});
}

// What rolls or spins against its friction is left at the bound.
void Rows::add_twist(std::size_t index) {
  const RowBlock& block = blocks[index];
  if (block.K[0][0] <= kRigid * block.free_response) return;
  const double radius = block.friction * pressure(block), most = block.torsion * pressure(block);
  const double spun = block.lambda[0] + block.base[0];
  if (most > 0.0 && (std::abs(spun) < kInside * most || spun * error(block, 0) < 0.0))
    active_.push_back({index, 0});
  const Tangential held{block.lambda[1] + block.base[1], block.lambda[2] + block.base[2]};
  if (radius == 0.0 || (!is_within_disc(held, kInside * radius) &&
                        held[0] * error(block, 1) + held[1] * error(block, 2) >= 0.0))
    return;
  active_.push_back({index, 1});
  active_.push_back({index, 2});
}

void Rows::find_active() {
  active_.clear();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const RowBlock& block = blocks[i];
    if (block.kind == RowBlock::Kind::kContact)
      add_contact(i);
    else if (block.kind == RowBlock::Kind::kTwist)
      add_twist(i);
    else if (block.lambda[0] > block.low && block.lambda[0] < block.high && block.K[0][0] > 0.0)
      active_.push_back({i, 0});
  }
}

double Rows::softness(const Row& row) const {
  const RowBlock& block = blocks[row.block];
  return block.softness[row.row] + (row.row == 0 ? block.compliance : 0.0);
}

bool Rows::bodies_alone() const {
  return std::all_of(active_.begin(), active_.end(), [this](const Row& row) {
    const RowBlock& block = blocks[row.block];
    return std::all_of(block.ends.begin(), block.ends.begin() + static_cast<std::ptrdiff_t>(block.end_count),
                       [](const RowEnd& end) { return end.free; }) &&
           softness(row) > 0.0;
  });
}

bool Rows::factor_active() {
  by_bodies_ = bodies_alone();
  return by_bodies_ ? factor_bodies() : factor_rows();
}

void Rows::solve_factored() {
  if (by_bodies_)
    solve_bodies();
  else
    factor_.solve(missing_);
}

// An impulse on the row, with the friction that it drags along.
BodyFactor::Vector6 Rows::push(const Row& row, const RowEnd& end) const {
  BodyFactor::Vector6 push = end.J[row.row];
  for (std::size_t i = 0; i < 2; ++i)
    if (row.drag[i] != 0.0)
      for (std::size_t k = 0; k < 6; ++k) push[k] += row.drag[i] * end.J[i + 1][k];
  return push;
}

// The active rows from `i` on that are of one block.
std::span<const Rows::Row> Rows::rows_of_block(std::size_t i) const {
  std::size_t end = i + 1;
  while (end < active_.size() && active_[end].block == active_[i].block) ++end;
  return std::span(active_).subspan(i, end - i);
}

void Rows::add_to_bodies(std::span<const Row> rows) {
  const RowBlock& block = blocks[rows[0].block];
  std::array<std::array<BodyFactor::Vector6, 3>, 2> pushed, measured;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double grip = 1.0 / softness(rows[r]);
    for (std::size_t e = 0; e < block.end_count; ++e) {
      measured[e][r] = block.ends[e].J[rows[r].row];
      pushed[e][r] = push(rows[r], block.ends[e]);
      for (double& entry : pushed[e][r]) entry *= grip;
    }
  }
  for (std::size_t a = 0; a < block.end_count; ++a)
    for (std::size_t b = 0; b < block.end_count; ++b)
      body_factor_.add(block.ends[a].offset / 6, std::span(pushed[a]).first(rows.size()),
                       block.ends[b].offset / 6, std::span(measured[b]).first(rows.size()));
}

bool Rows::factor_bodies() {
  const bool symmetric = std::none_of(active_.begin(), active_.end(), [](const Row& row) {
    return row.drag[0] != 0.0 || row.drag[1] != 0.0;
  });
  body_factor_.start(bodies, symmetric);
  for (const Row& row : active_)
    if (const RowBlock& block = blocks[row.block]; block.end_count == 2)
      body_factor_.connect(block.ends[0].offset / 6, block.ends[1].offset / 6);
  if (!body_factor_.place(kMostEntries)) return false;
  for (std::size_t i = 0; i < active_.size();) {
    const std::span<const Row> rows = rows_of_block(i);
    add_to_bodies(rows);
    i += rows.size();
  }
  return body_factor_.factor();
}

void Rows::solve_bodies() {
  body_steps_.assign(6 * bodies.size(), 0.0);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const RowBlock& block = blocks[active_[i].block];
    const double impulse = missing_[i] / softness(active_[i]);
    for (std::size_t e = 0; e < block.end_count; ++e) {
      const BodyFactor::Vector6 pushed = push(active_[i], block.ends[e]);
      for (std::size_t k = 0; k < 6; ++k) body_steps_[block.ends[e].offset + k] += impulse * pushed[k];
    }
  }
  body_factor_.solve(body_steps_);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const RowBlock& block = blocks[active_[i].block];
    double left = missing_[i];
    for (std::size_t e = 0; e < block.end_count; ++e)
      left -= dot(block.ends[e].J[active_[i].row], &body_steps_[block.ends[e].offset]);
    missing_[i] = left / softness(active_[i]);
  }
}

bool Rows::factor_rows() {
  factor_.clear();
  std::size_t block = kNoBlock, first = 0;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Row& row = active_[i];
    if (row.block != block) {
      block = row.block;
      first = 0;
      while (active_[first].block != block && !meet(blocks[active_[first].block], blocks[block])) ++first;
    }
    factor_.add(first);
    if (factor_.entries() > kMostEntries) return false;
    for (std::size_t j = first; j <= i; ++j) {
      const Row& other = active_[j];
      const double both = response(blocks[block], row.row, blocks[other.block], other.row);
      factor_.at(i, j) = both + dragged(row, other);
      if (j < i) factor_.at(j, i) = both + dragged(other, row);
    }
    factor_.at(i, i) += softness(row);
  }
  return factor_.factor();
}

double Rows::find_missing() {
  missing_.resize(active_.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    missing_[i] = error(blocks[active_[i].block], active_[i].row);
    largest = std::max(largest, std::abs(missing_[i]));
  }
  return largest;
}

// The nearest impulses that the block's bounds allow.
std::array<double, 3> Rows::within_bounds(const RowBlock& block, const std::array<double, 3>& lambda) const {
  if (block.kind == RowBlock::Kind::kBounded) return {std::clamp(lambda[0], block.low, block.high), 0.0, 0.0};
  const bool is_contact = block.kind == RowBlock::Kind::kContact;
  const double most = is_contact ? 0.0 : block.torsion * pressure(block);
  const double normal = is_contact ? std::max(block.low, lambda[0])
                                   : std::clamp(lambda[0] + block.base[0], -most, most) - block.base[0];
  const double pressing = is_contact ? std::max(0.0, normal + block.base[0]) : pressure(block);
  const double radius = block.friction * pressing;
  const Tangential held = within_disc({lambda[1] + block.base[1], lambda[2] + block.base[2]}, radius);
  return {normal, held[0] - block.base[1], held[1] - block.base[2]};
}

// Moves by what missing_ holds, and back to the bounds. False where a bound was met.
bool Rows::step_active() {
  steps_.assign(blocks.size(), {});
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Row& row = active_[i];
    steps_[row.block][row.row] += missing_[i];
    for (std::size_t k = 0; k < 2; ++k) steps_[row.block][k + 1] += row.drag[k] * missing_[i];
  }
  bool free = true;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    std::array<double, 3> next = blocks[k].lambda;
    for (std::size_t i = 0; i < 3; ++i) next[i] += steps_[k][i];
    const std::array<double, 3> allowed = within_bounds(blocks[k], next);
    for (std::size_t i = 0; i < 3; ++i) steps_[k][i] = allowed[i] - blocks[k].lambda[i];
    free = free && (blocks[k].drags || allowed == next);
    change(blocks[k], steps_[k]);
  }
  return free;
}

bool Rows::solve_active(double enough) {
  for (int step = 0; step < kMostSteps; ++step) {
    find_active();
    if (active_.empty()) return true;
    if (!factor_active()) {
      for (Row& row : active_) row.drag = {};
      for (RowBlock& block : blocks) block.drags = false;
      if (!factor_active()) return false;
    }
    bool free = true;
    for (int pass = 0; pass < kMostRefinements && free; ++pass) {
      if (find_missing() <= enough && step + pass > 0) return true;
      solve_factored();
      free = step_active();
    }
    if (free) return true;
  }
  return true;
}

}  // namespace visum::dynamics::impulse
