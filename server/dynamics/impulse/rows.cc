// The solver for rows with bounds.
//
// It works by proximal points (Rockafellar, Monotone operators and the proximal point algorithm, SIAM J.
// Control and Optimization 14, 1976). Each row is softened by s (lambda - c), where c is the impulse from
// which lambda came; c follows after each solution. Rows that repeat or, by rounding, contradict each other
// then have one answer, the one nearest to the last tick's. At rest the softness causes no error at all. A
// box between two jaws that both stand fast lacks room by a rounding: there the normals of contacts give way
// a little more, as a spring, and settle.
//
// Rows at rest are not solved: if the starting impulses leave next to nothing missing, they are the answer.
// With mechanisms an answer near the start is looked for next (rows_near.cc); then one comes from soft points
// to firm ones (rows_soft.cc). Where mechanisms are driven apart, these come after the next way: each
// proximal point takes a sweep of projected Gauss-Seidel, which finds the rows that are at their bounds, and
// then solves the others at once (rows_active.cc), or with their bounds by Newton's method (rows_newton.cc).
// Where that does not end for free bodies, the rows are softened a hundredfold: near its centre such a point
// is easily found. It becomes the next centre, with less softness, until none is left over. As a last way,
// sweeps follow that nonlinear conjugate gradients speed up: Silcowitz-Hansen, Niebe, Erleben, A nonsmooth
// nonlinear conjugate gradient method for interactive contact force problems, Visual Computer 26 (2010). A
// sweep forwards and back counts as one gradient.
#include "server/dynamics/impulse/rows.h"

#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/friction_cone.h"

namespace visum::dynamics::impulse {
namespace {

// Share of a row's response to itself: of rows with two bounds, of contacts where mechanisms take part, and
// of contacts of free bodies alone. Where rows repeat each other the softness alone holds their impulses:
// steps from bound to bound and Newton's method cycle if it is small. More softness takes more points.
constexpr double kSoftness = 1e-6, kJointedSoftness = 3e-5, kFreeSoftness = 1e-4;
// Where a point is not found: the softness grows by one factor, and comes back by the other.
constexpr double kMostSoftness = 1.0, kSofter = 100.0, kFirmer = 0.1;
constexpr int kMostSoftenings = 10;  // in one solution
// Proximal points in one solution.
constexpr int kMostPoints = 10;
// Rounds of sweeps and a solution at once, for one proximal point.
constexpr int kMostRounds = 8, kMostFreeRounds = 4;
// More rows change sides than steps from bound to bound could follow, so sweeps smooth what is left.
constexpr std::size_t kMostForSteps = 64;  // blocks
constexpr int kMostSmoothing = 20;

// True if the block has tangents that can move. Where nothing can move a contact, none of its impulses is
// defined.
bool has_tangents(const RowBlock& block) {
  return block.kind != RowBlock::Kind::kBounded && stiffness_of(block) > kRigid * block.free_response;
}

// Inverts the tangents' 2 x 2 response, softened.
void invert_tangents(RowBlock& block) {
  const double a = block.K[1] + block.softness[1], b = block.K[3], c = block.K[2] + block.softness[2];
  const double share = 1.0 / (a * c - b * b);
  block.inverse_tangential = {share * c, -share * b, share * a};
  block.sliding_step = 2.0 / (a + c + std::sqrt((a - c) * (a - c) + 4.0 * b * b));
}

}  // namespace

void Rows::prepare(RowIsland& island) {
  island_ = &island;
  begun_ = work_taken();
  blocks_ = island.blocks;
  velocities_ = island.velocities;
  bodies_ = island.bodies;
  responses_ = island.responses;
  has_pairs_ = has_places_ = has_lanes_ = has_order_ = has_factor_ = false;
  island_->largest_change = 0.0;
  island_->sweep_units = 0;
  for (RowBlock& block : blocks_) {
    for (std::size_t e = 0; e < block.end_count; ++e) {
      const RowEnd& end = block.ends[e];
      island_->sweep_units += block.dim * (end.free ? 1 : 1 + end.size / WorkBudget::kMultiplications);
      // A mechanism's share of K is on the diagonal of its W.
      if (end.free) continue;
      const double* W = &responses_[end.response + end.first * end.size + end.first];
      for (std::size_t i = 0; i < block.dim; ++i) block.K[i] += W[i * end.size + i];
      if (block.dim == 3) block.K[3] += W[end.size + 2];
    }
  }
  hold_softly(least_softness());
  island_->movable = std::ranges::none_of(blocks_, is_rigid);
}

double Rows::least_softness() const {
  return responses_.empty() ? kFreeSoftness : kJointedSoftness;
}

// The proximal softness follows from K. Both tangents get the same value.
void Rows::hold_softly(double share) {
  has_settings_ = false;
  const double beyond = share > least_softness() ? share : 0.0;
  for (RowBlock& block : blocks_) {
    if (block.kind == RowBlock::Kind::kBounded) {
      block.softness[0] = (kSoftness + beyond) * block.K[0];
      continue;
    }
    block.softness[0] = (block.give > 0.0 ? block.give + beyond : share) * block.K[0];
    block.softness[1] = block.softness[2] =
        0.5 * share * (block.K[1] + block.K[2]) + kRigid * block.free_response;
    invert_tangents(block);
  }
}

void Rows::soften(double share) {
  has_settings_ = false;
  for (RowBlock& block : blocks_) {
    for (std::size_t i = 0; i < block.dim; ++i) block.softness[i] += share * block.free_response;
    if (block.kind != RowBlock::Kind::kBounded) invert_tangents(block);
  }
}

void Rows::push(const RowBlock& block, const std::array<double, 3>& by) {
  for (std::size_t e = 0; e < block.end_count; ++e) {
    const RowEnd& end = block.ends[e];
    double* velocity = &velocities_[end.offset];
    if (end.free) {
      kernels_->push_body(end.MJ[0].data(), by.data(), velocity);
      continue;
    }
    // On a mechanism each impulse moves all of its rows.
    kernels_->push_by_responses(&responses_[end.response + end.first * end.size], end.size, by.data(),
                                block.dim, velocity);
  }
}

void Rows::change(RowBlock& block, const std::array<double, 3>& by) {
  push(block, by);
  for (std::size_t i = 0; i < block.dim; ++i) {
    block.lambda[i] += by[i];
    block.applied[i] += by[i];
  }
}

void Rows::move_normal(RowBlock& block, double to) {
  change(block, {to - block.lambda[0], 0.0, 0.0});
  block.lambda[0] = block.applied[0] = to;
}

// The miss of a row's equation: target - u - k lambda - s (lambda - c).
double Rows::error(const RowBlock& block, std::size_t row) const {
  const double soft = block.softness[row] * (block.lambda[row] - block.centre[row]);
  const double error = block.target[row] - velocity(block, row) - soft;
  return row == 0 ? error - block.compliance * block.lambda[0] : error;
}

// Nothing can move this row. A drive gives what it may against what it misses; a stop gives nothing, whatever
// it has started from.
double Rows::next_of_rigid(const RowBlock& block, double error) const {
  const double now = block.lambda[0];
  if (block.kind != RowBlock::Kind::kBounded) return now;
  const double least = kRigid * block.free_response;
  const bool is_law = std::isfinite(block.high - block.low);
  const double next = is_law ? now + (least > 0.0 ? error / least : 0.0) : 0.0;
  return std::clamp(next, block.low, block.high);
}

double Rows::next_normal(const RowBlock& block, double error) const {
  const double stiffness = stiffness_of(block);
  if (!(stiffness > kRigid * block.free_response)) return next_of_rigid(block, error);
  const double next = block.lambda[0] + error / stiffness;
  switch (block.kind) {
    case RowBlock::Kind::kContact:
      return std::max(block.low, next);
    case RowBlock::Kind::kTwist: {
      const double most = block.torsion * pressure(block);
      return std::clamp(next + block.base[0], -most, most) - block.base[0];
    }
    default:
      return std::clamp(next, block.low, block.high);
  }
}

double Rows::pressure(const RowBlock& block) const {
  const RowBlock& contact = block.kind == RowBlock::Kind::kTwist ? blocks_[block.contact] : block;
  return std::max(0.0, contact.lambda[0] + contact.base[0]);
}

Tangential Rows::tangents_step(const RowBlock& block, double e1, double e2) const {
  const Tangential start{block.lambda[1] + block.base[1], block.lambda[2] + block.base[2]};
  const double radius = block.friction * pressure(block);
  const auto& inverse = block.inverse_tangential;
  Tangential held{start[0] + inverse[0] * e1 + inverse[1] * e2, start[1] + inverse[1] * e1 + inverse[2] * e2};
  // A sliding contact's friction must point against the sliding, so both directions take a step of the same
  // size.
  if (!is_within_disc(held, radius)) {
    const double step = block.sliding_step;
    held = within_disc({start[0] + step * e1, start[1] + step * e2}, radius);
  }
  return {held[0] - start[0], held[1] - start[1]};
}

// Returns by how much the velocities were not as the block's rows ask. The normal comes first: the tangents'
// bound depends on it.
double Rows::relax(RowBlock& block) {
  const double next = next_normal(block, error(block, 0));
  const double normal = std::abs(next - block.lambda[0]) * stiffness_of(block);
  move_normal(block, next);
  if (!has_tangents(block)) return normal;
  const Tangential along = tangents_step(block, error(block, 1), error(block, 2));
  change(block, {0.0, along[0], along[1]});
  return std::max({normal, std::abs(along[0]) * block.K[1], std::abs(along[1]) * block.K[2]});
}

std::array<double, 3> Rows::errors(const RowBlock& block) const {
  std::array<double, 3> errors{};
  for (std::size_t i = 0; i < block.dim; ++i) errors[i] = error(block, i);
  return errors;
}

// The same figure as relax() finds, but here nothing moves.
double Rows::miss(const RowBlock& block, const std::array<double, 3>& errors) const {
  const double normal =
      std::max(0.0, std::abs(next_normal(block, errors[0]) - block.lambda[0]) * stiffness_of(block));
  if (!has_tangents(block)) return normal;
  const Tangential along = tangents_step(block, errors[1], errors[2]);
  return std::max({normal, std::abs(along[0]) * block.K[1], std::abs(along[1]) * block.K[2]});
}

double Rows::largest_miss() {
  count_work(island_->sweep_units);
  find_errors();
  double largest = 0.0;
  const auto look_at = [&](std::size_t i) { largest = std::max(largest, miss(blocks_[i], errors_[i])); };
  if (has_lanes_) {
    largest = contact_lanes_.largest_miss();
    std::ranges::for_each(contact_lanes_.others(), look_at);
  } else {
    for (std::size_t i = 0; i < blocks_.size(); ++i) look_at(i);
  }
  return largest;
}

void Rows::find_errors() {
  errors_.resize(blocks_.size());
  const auto look_at = [&](std::size_t i) { errors_[i] = errors(blocks_[i]); };
  if (has_lanes_) {
    if (!has_settings_) contact_lanes_.take_settings(blocks_);
    has_settings_ = true;
    contact_lanes_.find_errors(blocks_, velocities_.data(), errors_);
    std::ranges::for_each(contact_lanes_.others(), look_at);
  } else {
    for (std::size_t i = 0; i < blocks_.size(); ++i) look_at(i);
  }
}

double Rows::sweep(bool forwards) {
  count_work(island_->sweep_units);
  double largest = 0.0;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    largest = std::max(largest, relax(blocks_[forwards ? i : blocks_.size() - 1 - i]));
  return largest;
}

// Puts the starting impulses into the velocities. They are the first proximal point, too.
bool Rows::start() {
  bool changed = false;
  for (RowBlock& block : blocks_) {
    std::array<double, 3> by{};
    for (std::size_t i = 0; i < block.dim; ++i) by[i] = block.lambda[i] - block.applied[i];
    if (by == std::array<double, 3>{}) continue;
    push(block, by);
    block.applied = block.lambda;
    changed = true;
  }
  move_centres(0.0);
  return changed;
}

// A yielding normal keeps its `rest`; where it is softened `beyond` its own share, the centre of both springs
// together counts.
void Rows::move_centres(double beyond) {
  has_settings_ = false;
  for (RowBlock& block : blocks_) {
    block.centre = block.lambda;
    if (block.give == 0.0) continue;
    if (beyond == 0.0)
      block.centre[0] = block.rest;
    else
      block.centre[0] += block.give / (block.give + beyond) * (block.rest - block.lambda[0]);
  }
}

double Rows::largest_change() const {
  double largest = 0.0;
  for (const RowBlock& block : blocks_)
    for (std::size_t i = 0; i < block.dim; ++i)
      largest = std::max(largest, block.K[i] * std::abs(block.lambda[i]));
  return largest;
}

double Rows::note_change() {
  return island_->largest_change = std::max(island_->largest_change, largest_change());
}

double Rows::solve(int most_sweeps, double least, double share, double rest) {
  island_->changed = start();
  island_->inexact = false;
  island_->rests = island_->solved = rest_at_start(least, share, rest);
  if (island_->rests) return 0.0;
  const bool alone = responses_.empty();
  // Sweeps alone say what rows on mechanisms give that nothing can move.
  const bool movable = alone || island_->movable;
  if (!alone && island_->calm && movable) {
    const double missed = largest_miss();
    if (settle_near_start(missed, std::max(least, share * note_change()))) {
      island_->solved = true;
      note_change();
      return missed;
    }
  }
  island_->changed = true;
  double missed = 0.0;
  const bool softly = movable && has(RowBlock::Kind::kContact) && !has(RowBlock::Kind::kTwist);
  // Where a mechanism is driven apart, contacts have several answers, and one near the start may press too
  // hard: soft points come later there.
  const bool at_first = alone || island_->calm;
  if (softly && at_first) {
    missed = largest_miss();
    island_->solved = follow_soft_points(missed, least, share);
    if (island_->solved || island_->inexact) return missed;
  }
  // One sweep tells which rows are at their bounds, and how large the changes are.
  missed = std::max(missed, sweep(true));
  const double enough = std::max(least, share * note_change());
  island_->solved = follow_points(enough) ||
                    (softly && !at_first && follow_soft_points(largest_miss(), least, share)) ||
                    (sweep_and_accelerate(most_sweeps, enough) <= enough && left_by_softness() <= enough);
  return missed;
}

// The error that the softness leaves. A yielding normal is meant to stay soft, but no softer.
double Rows::left_by_softness() const {
  double left = 0.0;
  for (const RowBlock& block : blocks_)
    for (std::size_t i = 0; i < block.dim; ++i) {
      double pull = block.softness[i] * (block.lambda[i] - block.centre[i]);
      if (i == 0) pull -= block.give * block.K[0] * (block.lambda[0] - block.rest);
      left = std::max(left, std::abs(pull));
    }
  return left;
}

// Returns false where a point was not found, or the last one left too much.
bool Rows::follow_points(double enough) {
  const bool alone = responses_.empty();
  const double least = least_softness();
  double share = least;
  int softenings = 0;
  for (int point = 0; point < kMostPoints;) {
    const bool found = settle(enough) <= enough;
    if (!found && !alone) return false;
    if (!found && ++softenings > kMostSoftenings) {
      hold_softly(least);
      move_centres(0.0);
      return false;
    }
    if (found && share == least) {
      if (left_by_softness() <= enough) return true;
      ++point;
    } else {
      share = found ? std::max(least, kFirmer * share) : std::min(kMostSoftness, kSofter * share);
      hold_softly(share);
    }
    move_centres(share > least ? share : 0.0);
  }
  return false;
}

double Rows::sweep_gently(int sweeps) {
  start();
  island_->rests = island_->frozen = island_->solved = island_->inexact = false;
  island_->changed = true;
  const double missed = sweep(true);
  for (int k = 1; k < sweeps; ++k) sweep(k % 2 == 0);
  return missed;
}

bool Rows::has(RowBlock::Kind kind) const {
  return std::ranges::any_of(blocks_, [kind](const RowBlock& block) { return block.kind == kind; });
}

// Comes after a sweep, which has found the rows at their bounds. With mechanisms a solution at once is dear,
// so two more sweeps come before it and after it; what they smooth is not left to the next look-ahead. Each
// round begins with Newton's method, with mechanisms from the second on. Returns the largest miss at the end.
double Rows::settle(double enough) {
  const bool alone = responses_.empty();
  const bool twists = has(RowBlock::Kind::kTwist);
  double largest = 0.0;
  for (int round = 0; round < (alone ? kMostFreeRounds : kMostRounds); ++round) {
    if (round > 0 || !alone)
      if (largest = sweep_often(2, enough); largest <= enough) return largest;
    if ((round > 0 || alone) && !twists) {
      if (largest = newton({.enough = enough, .most_passes = kMostNewtonPasses}); largest <= enough && alone)
        return largest;
      if (largest <= enough) continue;
    }
    if (round > 0 && blocks_.size() > kMostForSteps) {
      if (largest = sweep_often(kMostSmoothing, enough); largest <= enough) return largest;
      continue;
    }
    const bool solved = solve_active(enough);
    if (solved && !alone) continue;
    if (largest = largest_miss(); largest <= enough || !solved) return largest;
  }
  return largest;
}

double Rows::sweep_often(int sweeps, double enough) {
  double largest = 0.0;
  for (int k = 0; k < sweeps; ++k)
    if (largest = sweep(k % 2 == 0); largest <= enough) break;
  return largest;
}

double Rows::sweep_and_accelerate(int most_sweeps, double enough) {
  direction_.lambda.assign(3 * blocks_.size(), 0.0);
  direction_.velocities.assign(velocities_.size(), 0.0);
  double last_norm = 0.0, largest = 0.0;
  for (int k = 0; k < most_sweeps; ++k) {
    keep(last_);
    largest = sweep(true);
    if (largest <= enough) return largest;
    largest = sweep(false);
    if (largest <= enough || k + 1 == most_sweeps) return largest;
    // The gradient is what the two sweeps have moved. Where it grows, the directions of before are dropped
    // (Fletcher-Reeves with restart).
    double norm = 0.0;
    for (std::size_t i = 0; i < velocities_.size(); ++i) {
      const double moved = velocities_[i] - last_.velocities[i];
      norm += moved * moved;
    }
    const double beta = last_norm > 0.0 ? norm / last_norm : 2.0;
    last_norm = norm;
    const double keep = beta <= 1.0 ? beta : 0.0;
    // Along the old direction once more, for velocities and impulses alike.
    for (std::size_t i = 0; i < velocities_.size(); ++i) {
      const double old = direction_.velocities[i];
      direction_.velocities[i] = keep * old + velocities_[i] - last_.velocities[i];
      velocities_[i] += keep * old;
    }
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      for (std::size_t j = 0; j < blocks_[i].dim; ++j) {
        double& direction = direction_.lambda[3 * i + j];
        const double old = direction;
        direction = keep * old + blocks_[i].lambda[j] - last_.lambda[3 * i + j];
        blocks_[i].lambda[j] += keep * old;
        blocks_[i].applied[j] += keep * old;
      }
    }
  }
  return largest;
}

}  // namespace visum::dynamics::impulse
