// The rows that are within their bounds, solved at once: the subspace step of Silcowitz-Hansen, Niebe,
// Erleben, Projected Gauss-Seidel subspace minimization method for interactive rigid body dynamics, GRAPP
// 2010. Sweeps find out which rows those are. The step then finds their impulses, whatever the ratio of
// masses is.
//
// Symbols: A is the response of these rows to each other, S their softness and compliance, r what they miss.
//   (A + S) dl = r, taken as far as the first bound
// Where the rows hold free bodies only, the system is solved for the bodies (body_factor.h), otherwise as it
// stands.
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/dynamics/impulse/friction_cone.h"
#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

// Solutions with the same active rows.
constexpr int kMostRefinements = 2;
// Numbers in the factor of rows: beyond this, sweeps alone are quicker. Numbers in each triangle of that of
// bodies: 16 MB.
constexpr std::size_t kMostEntries = 400'000, kMostBodyEntries = 2'000'000;
constexpr double kInside =
    1.0 - 1e-9;                    // share of the friction radius up to which a contact counts as sticking
constexpr double kAtBound = 1e-9;  // share of a step, or of a radius, that counts as zero
constexpr double kSameSoftness = 1e-6;   // relative difference that counts as rounding
constexpr std::size_t kMostPaired = 64;  // blocks whose responses to each other are kept

// The largest a in 0..1 with a dx <= room. Where a step leads back to the bound from beyond, all of it.
double share_below(double room, double dx) {
  return dx <= room || dx <= 0.0 ? 1.0 : std::max(0.0, room / dx);
}

// The largest a in 0..1 with |t + a dt| <= r + a dr: how far a step of the tangents stays in the friction
// disc, whose radius changes along.
double share_within_cone(const Tangential& t, const Tangential& dt, double r, double dr) {
  const double A = dt[0] * dt[0] + dt[1] * dt[1] - dr * dr, B = t[0] * dt[0] + t[1] * dt[1] - r * dr;
  const double C = std::min(0.0, t[0] * t[0] + t[1] * t[1] - r * r);
  if (A + 2.0 * B + C <= 0.0 && r + dr >= 0.0) return 1.0;
  if (C >= -kAtBound * r * r && B > 0.0) return 0.0;
  // A a^2 + 2 B a + C has one root on each side of 0, or both on the same side as A. This form loses no
  // digits.
  const double root = std::sqrt(std::max(0.0, B * B - A * C));
  return std::min(1.0, B > 0.0 ? -C / (B + root) : (root - B) / A);
}

}  // namespace

// The velocity that a unit impulse on row s of an end causes in row r of another, and the other way round.
double Rows::response(const RowEnd& a, std::size_t r, const RowEnd& b, std::size_t s) const {
  return a.free ? dot(a.J[r], b.MJ[s].data()) : responses_[a.response + (a.first + r) * a.size + b.first + s];
}

// True for blocks that meet on one mechanism, and touch nothing else.
bool Rows::stand_in_W(const RowBlock& a, const RowBlock& b) {
  return a.end_count == 1 && b.end_count == 1 && !a.ends[0].free;
}

void Rows::start_pairs() {
  if (has_pairs_) return;
  has_pairs_ = true;
  const std::size_t pairs = blocks_.size() <= kMostPaired ? blocks_.size() * blocks_.size() : 0;
  pairs_known_.assign(pairs, 0);
  if (pairs_.size() < 9 * pairs) pairs_.resize(9 * pairs);
}

Rows::Responses Rows::look_up_responses(const RowBlock& a, const RowBlock& b, std::array<double, 9>& memory) {
  if (stand_in_W(a, b) || pairs_known_.empty()) return find_responses(a, b, memory.data());
  const auto number = static_cast<std::size_t>(&a - blocks_.data()) * blocks_.size() +
                      static_cast<std::size_t>(&b - blocks_.data());
  double* const found = &pairs_[9 * number];
  if (std::exchange(pairs_known_[number], 1)) return {found, 3};
  return find_responses(a, b, found);
}

Rows::Responses Rows::find_responses(const RowBlock& a, const RowBlock& b, double* found) const {
  if (stand_in_W(a, b)) {
    const RowEnd &at = a.ends[0], &by = b.ends[0];
    return {&responses_[at.response + at.first * at.size + by.first], at.size};
  }
  std::fill_n(found, 9, 0.0);
  for (std::size_t i = 0; i < a.end_count; ++i)
    for (std::size_t j = 0; j < b.end_count; ++j)
      if (meet(a.ends[i], b.ends[j])) add_responses(a, a.ends[i], b, b.ends[j], found);
  return {found, 3};
}

void Rows::add_responses(const RowBlock& a, const RowEnd& end_a, const RowBlock& b, const RowEnd& end_b,
                         double* to) const {
  if (end_a.free && a.dim == 3 && b.dim == 3)
    return kernels_->add_responses_of_rows(end_a.J[0].data(), end_b.MJ[0].data(), to);
  for (std::size_t r = 0; r < a.dim; ++r)
    for (std::size_t s = 0; s < b.dim; ++s) to[3 * r + s] += response(end_a, r, end_b, s);
}

// The velocity that a unit impulse on row s of b's block causes in row a.
double Rows::response(const Responses& of, const Row& a, std::size_t s) {
  if (a.row != kAcross) return of(a.row, s);
  return a.across[0] * of(1, s) + a.across[1] * of(2, s);
}

double Rows::response(const Responses& of, const Row& a, const Row& b) {
  if (b.row != kAcross) return response(of, a, b.row);
  return b.across[0] * response(of, a, 1) + b.across[1] * response(of, a, 2);
}

// The velocity that b's friction causes in row a, if b's normal drags friction along.
double Rows::dragged(const Responses& of, const Row& a, const Row& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 2; ++i)
    if (b.drag[i] != 0.0) sum += b.drag[i] * response(of, a, i + 1);
  return sum;
}

// A sliding contact takes part with its normal only. Its tangents come back once they are asked to slide
// less.
void Rows::add_contact(std::size_t index) {
  RowBlock& block = blocks_[index];
  if (block.K[0] <= kRigid * block.free_response || !(block.lambda[0] > block.low)) return;
  const double radius = block.friction * pressure(block);
  const Tangential held{block.lambda[1] + block.base[1], block.lambda[2] + block.base[2]};
  const bool slides = radius == 0.0 || block.at_bound ||
                      (!is_within_disc(held, kInside * radius) &&
                       held[0] * error(block, 1) + held[1] * error(block, 2) >= 0.0);
  Row normal{index, 0};
  block.drags = slides && radius > 0.0;
  if (block.drags) normal.drag = {block.friction * held[0] / radius, block.friction * held[1] / radius};
  active_.push_back(normal);
  if (slides) return;
  active_.push_back({index, 1});
  active_.push_back({index, 2});
}

// Rolling or spinning against friction stays at its bound and takes no part.
void Rows::add_twist(std::size_t index) {
  const RowBlock& block = blocks_[index];
  if (block.K[0] <= kRigid * block.free_response) return;
  const double radius = block.friction * pressure(block), most = block.torsion * pressure(block);
  const double spun = block.lambda[0] + block.base[0];
  if (most > 0.0 && (std::abs(spun) < kInside * most || spun * error(block, 0) < 0.0))
    active_.push_back({index, 0});
  const Tangential held{block.lambda[1] + block.base[1], block.lambda[2] + block.base[2]};
  if (radius == 0.0 || block.at_bound ||
      (!is_within_disc(held, kInside * radius) &&
       held[0] * error(block, 1) + held[1] * error(block, 2) >= 0.0))
    return;
  active_.push_back({index, 1});
  active_.push_back({index, 2});
}

void Rows::find_active() {
  active_.clear();
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const RowBlock& block = blocks_[i];
    if (block.kind == RowBlock::Kind::kContact)
      add_contact(i);
    else if (block.kind == RowBlock::Kind::kTwist)
      add_twist(i);
    else if (block.lambda[0] > block.low && block.lambda[0] < block.high &&
             block.K[0] > kRigid * block.free_response)
      active_.push_back({i, 0});
  }
}

bool Rows::is_factored() const {
  return has_factor_ && factored_ == active_ && factored_softness_ == active_softness_;
}

bool Rows::has_factor_of_same_rows() const {
  if (!has_factor_ || factored_.size() != active_.size()) return false;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Row &before = factored_[i], &now = active_[i];
    if (before.block != now.block || before.row != now.row || before.drags() != now.drags()) return false;
    // The proximal point's, without what the round disc gives to a row across the sliding.
    const double soft = factored_softness_[i] - before.compliance, now_soft = softness(now) - now.compliance;
    if (std::abs(soft - now_soft) > kSameSoftness * now_soft) return false;
  }
  return true;
}

// Rows that all stick have the same system from pass to pass.
bool Rows::factor_active() {
  active_softness_.resize(active_.size());
  std::ranges::transform(active_, active_softness_.begin(), [this](const Row& row) { return softness(row); });
  if (is_factored()) return true;
  const std::size_t kept = factored_rows();
  has_factor_ = false;
  system_ = bodies_alone() ? System::kBodies : prepare_small() ? System::kSmall : System::kRows;
  const bool found = system_ == System::kBodies  ? factor_bodies(kMostBodyEntries)
                     : system_ == System::kSmall ? factor_small()
                                                 : factor_rows(kept);
  if (!found) return false;
  has_factor_ = true;
  factored_ = active_;
  factored_softness_ = active_softness_;
  return true;
}

void Rows::solve_factored() {
  switch (system_) {
    case System::kBodies:
      return body_factor_.solve(body_rows_, missing_);
    case System::kSmall:
      return small_.solve(missing_);
    default:
      factor_.solve(missing_);
  }
}

void Rows::find_groups() {
  groups_.clear();
  for (std::size_t i = 0; i < active_.size();) {
    const std::span<const Row> rows = rows_of_block(i);
    const bool drags = std::ranges::any_of(rows, &Row::drags);
    groups_.push_back({i, i + rows.size(), &blocks_[active_[i].block], drags});
    i += rows.size();
  }
}

std::size_t Rows::factored_rows() const {
  if (!has_factor_ || system_ != System::kRows) return 0;
  const std::size_t most = std::min(active_.size(), factored_.size());
  std::size_t kept = 0;
  while (kept < most && factored_[kept] == active_[kept] &&
         factored_softness_[kept] == active_softness_[kept])
    ++kept;
  return kept;
}

// Rows before `kept` are as in the factor before.
bool Rows::factor_rows(std::size_t kept) {
  // The pattern: each row begins at the first active row that it shares a body or mechanism with.
  find_groups();
  start_pairs();
  factor_.restart(kept);
  for (const Group& group : groups_) {
    if (group.end <= kept) continue;
    const auto first = std::ranges::find_if(groups_, [&](const Group& other) {
      return other.begin == group.begin || meet(*other.block, *group.block);
    });
    for (std::size_t i = group.begin; i < group.end; ++i) {
      if (i < kept) continue;
      factor_.add(first->begin);
      if (factor_.entries() > kMostEntries) return false;
      // Its entries, and their elimination.
      const std::size_t width = i - first->begin + 1;
      count_work(width * (kPerResponse + width / WorkBudget::kMultiplications));
    }
  }
  factor_.place();
  for (const Group& group : groups_) {
    if (group.end <= kept) continue;
    for (const Group& other : std::span(groups_.data(), &group + 1))
      if (other.begin >= factor_.first(group.begin)) add_responses(group, other, kept);
    for (std::size_t i = std::max(kept, group.begin); i < group.end; ++i)
      factor_.at(i, i) += active_softness_[i];
  }
  return factor_.factor();
}

// The entries of two blocks' active rows, the first's from `from` on. What one row's impulse does to another
// follows from the blocks' responses to each other.
void Rows::add_responses(const Group& at, const Group& by, std::size_t from) {
  if (!meet(*at.block, *by.block)) return;
  std::array<double, 9> memory, memory_back;
  const Responses there = look_up_responses(*at.block, *by.block, memory);
  const Responses back = at.drags ? look_up_responses(*by.block, *at.block, memory_back) : there;
  const bool drags = at.drags || by.drags;
  for (std::size_t i = std::max(from, at.begin); i < at.end; ++i) {
    const Row& row = active_[i];
    for (std::size_t j = by.begin; j < std::min(by.end, i + 1); ++j) {
      const Row& other = active_[j];
      const double both = response(there, row, other);
      factor_.at(i, j) = drags ? both + dragged(there, row, other) : both;
      if (j < i) factor_.at(j, i) = drags ? both + dragged(back, other, row) : both;
    }
  }
}

double Rows::find_missing(bool errors_known) {
  if (has_lanes_ && !errors_known) find_errors();
  errors_known = errors_known || has_lanes_;
  missing_.resize(active_.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Row& row = active_[i];
    const auto of = [&](std::size_t k) {
      return errors_known ? errors_[row.block][k] : error(blocks_[row.block], k);
    };
    missing_[i] = row.row == kAcross ? row.across[0] * of(1) + row.across[1] * of(2) : of(row.row);
    largest = std::max(largest, std::abs(missing_[i]));
  }
  return largest;
}

std::array<double, 3> Rows::within_bounds(const RowBlock& block, const std::array<double, 3>& lambda,
                                          double pressure) {
  if (block.kind == RowBlock::Kind::kBounded) return {std::clamp(lambda[0], block.low, block.high), 0.0, 0.0};
  const bool is_contact = block.kind == RowBlock::Kind::kContact;
  const double most = is_contact ? 0.0 : block.torsion * pressure;
  const double normal = is_contact ? std::max(block.low, lambda[0])
                                   : std::clamp(lambda[0] + block.base[0], -most, most) - block.base[0];
  const double pressing = is_contact ? std::max(0.0, normal + block.base[0]) : pressure;
  const double radius = block.friction * pressing;
  const Tangential held = within_disc({lambda[1] + block.base[1], lambda[2] + block.base[2]}, radius);
  return {normal, held[0] - block.base[1], held[1] - block.base[2]};
}

// How much of a block's step its bounds allow; they move with the pressure. The tangents of a sliding contact
// follow its normal, and limit nothing.
Rows::Shares Rows::shares_within_bounds(const RowBlock& block, const std::array<double, 3>& step) const {
  Shares shares;
  const double dx = step[0];
  double pressing = 0.0;  // how much the step adds to the pressure
  if (block.kind == RowBlock::Kind::kTwist) {
    pressing = steps_[block.contact][0];
    const double most = block.torsion * pressure(block), spun = block.lambda[0] + block.base[0];
    if (dx != 0.0)
      shares.first = std::min(share_below(most - spun, dx - block.torsion * pressing),
                              share_below(most + spun, -dx - block.torsion * pressing));
  } else {
    shares.first = share_below(block.lambda[0] - block.low, -dx);
    if (block.kind == RowBlock::Kind::kBounded)
      shares.first = std::min(shares.first, share_below(block.high - block.lambda[0], dx));
    else
      pressing = dx;
  }
  if (block.drags || (step[1] == 0.0 && step[2] == 0.0)) return shares;
  const Tangential held{block.lambda[1] + block.base[1], block.lambda[2] + block.base[2]};
  shares.tangents = share_within_cone(held, {step[1], step[2]}, block.friction * pressure(block),
                                      block.friction * pressing);
  return shares;
}

// Moves by the changes in missing_, as far as the first bound; a row that meets its bound stays there.
// Impulses that balance each other would no longer do so if only some of them were cut, so all rows take the
// same share of the step. Returns false where a bound was met.
bool Rows::step_active() {
  // The step of each block, with the friction that follows its normal.
  steps_.assign(blocks_.size(), {});
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Row& row = active_[i];
    steps_[row.block][row.row] += missing_[i];
    for (std::size_t k = 0; k < 2; ++k) steps_[row.block][k + 1] += row.drag[k] * missing_[i];
  }
  // The smallest share that any block can take.
  shares_.resize(blocks_.size());
  double share = 1.0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    shares_[k] = shares_within_bounds(blocks_[k], steps_[k]);
    share = std::min({share, shares_[k].first, shares_[k].tangents});
  }
  const auto stops = [&](double own) { return own < 1.0 && own <= share + kAtBound; };
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    RowBlock& block = blocks_[k];
    std::array<double, 3> next = block.lambda;
    for (std::size_t i = 0; i < 3; ++i) next[i] += share * steps_[k][i];
    const bool twists = block.kind == RowBlock::Kind::kTwist;
    // Exactly onto the bound: only rounding keeps it away.
    if (stops(shares_[k].first) && !twists) next[0] = steps_[k][0] < 0.0 ? block.low : block.high;
    if (stops(shares_[k].tangents)) block.at_bound = true;
    // A twist's contact stands before it in the list, so its step has been limited already.
    const double pressing = twists ? std::max(0.0, pressure(block) + steps_[block.contact][0]) : 0.0;
    const std::array<double, 3> allowed = within_bounds(block, next, pressing);
    for (std::size_t i = 0; i < 3; ++i) steps_[k][i] = allowed[i] - block.lambda[i];
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k) change(blocks_[k], steps_[k]);
  return share == 1.0;
}

bool Rows::solve_active(double enough, int most_steps) {
  for (RowBlock& block : blocks_) block.at_bound = false;
  // From active set to active set. Where the factor fails, it is tried once more without dragged friction.
  for (int step = 0; step < most_steps; ++step) {
    count_work(island_->sweep_units);
    find_active();
    if (active_.empty()) return true;
    if (!factor_active()) {
      for (Row& row : active_) row.drag = {};
      for (RowBlock& block : blocks_) block.drags = false;
      if (!factor_active()) return false;
    }
    bool free = true;
    for (int pass = 0; pass < kMostRefinements && free; ++pass) {
      if (find_missing() <= enough && (step + pass > 0 || system_ != System::kBodies)) return true;
      solve_factored();
      free = step_active();
    }
    if (free) return true;
  }
  return true;
}

}  // namespace visum::dynamics::impulse
