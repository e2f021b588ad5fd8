// The aims of the rows at each moment, and the use of their impulses.
//
// clang-format off
// Contacts. Symbols:
//   u = (u_n, u_t)   velocity of A against B at the contact, along its normal and across
//   a = (a_n, a_t)   relative acceleration in free flight
//   d, s             depth of the overlap, and the layer that is left alone
//   h, e             step, and restitution
//   P0, P1, P2       impulses of the three moments
//
//   hit     u_n >= e |u_n before| (Newton); or twice: to 0, then at least (1 + e) of that impulse (Poisson).
//           Where friction turns the other way in a hit, Newton's law can gain energy (Kane, Levinson,
//           Dynamics: Theory and Applications, 1985). There e is cut back until the hit gains none.
//   ahead   the look-ahead's displacement:
//           h u_n + h^2 a_n/2 >= d - s; of more than s beyond the layer only a share, at most at kMostPush,
//           and less what it has landed deep (note_landings())
//           u_t + h a_t/2 = 0, or the contact slides
//   after   u_n >= 0 with P1 + P2 >= 0;  u_t = 0, or it slides with the cone of all three impulses
//
// A contact that is foreseen (d < 0) takes part in `ahead` alone: the bodies come as near as to touch, and
// the next step finds the contact.
//
// P2 may take back what P1 gave. A body at rest therefore has velocity zero at the end of each step, and an
// impulse of h m g per step: half of it at t, half at t+h, as everything else has it.
// Rolling and torsional friction, where surfaces have them: the bodies' relative angular velocity w is held
// at w = 0 by torques of at most  rho P_n about the tangents (a disc, as friction), tau P_n about the normal;
// rho and tau are in m.
//
// Sources: impulses for collisions and contacts alike, Mirtich, Canny, Impulse-based simulation of rigid
// bodies, SI3D 1995; contacts beside joints that impulses hold, Bender, Schmitt, Constraint-based collision
// and contact handling using impulses, CASA 2006; rolling and torsional friction, Johnson, Contact Mechanics
// (1985), sections 8.3 and 9.1, as MuJoCo's condim 6.
// clang-format on
#include "server/dynamics/impulse/bounded.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/world/joint_kinds.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int kMostSweeps = 200;
constexpr int kGentleSweeps = 10;
constexpr double kGentleSoftness = 1.0;  // share of the rows' free response
constexpr double kEnough = 1e-11;        // m/s, rad/s that may be missing
// Share of what impulses change that may be missing: of contacts between free bodies, and where mechanisms
// take part, whose joints are closed to d_max only. 0 for a hit, whose bounce is exact.
constexpr double kShare = 1e-7, kMechanismShare = 1e-6;
// A contact with a body that another engine moves: its compliance in (m/s)/N, and the layer that is left
// alone, m. The other body cannot give way in this engine's solution, so whatever it squeezes must. At 1 ms
// the compliance is a spring of 2 MN/m. ODE leaves its own 10 µm alone.
constexpr double kYield = 1e-4;
constexpr double kYieldingLayerM = 2e-5;
constexpr double kSameEnergy =
    1e-7;                      // share of the energy that a hit gives and takes which counts as rounding
constexpr int kMostCuts = 12;  // halvings of the interval in which a bounce may lie
constexpr double kComesToRest =
    0.1;  // share of the miss that is allowed at rest: a body that has moved must get below it to rest
// Share of what a body falls in a step: an island that moves by no more stands still, and is frozen. The
// little that is missing would otherwise add up, and move it for ever. It must not grow with the island: a
// light body beneath a heavy one would hold its neighbours.
constexpr double kFrozenShare = 1e-8;
// An island that moves by no more than so many times that limit is solved more exactly. What a solution may
// miss would keep it moving, and what its forces lack when it is frozen, they lack from then on.
constexpr double kNearlyStill = 1000.0;
constexpr double kPushShare = 0.2;  // share of an overlap that is taken out in one step

// The part of an overlap that one step takes out: a share. Where bodies stand, the last of it goes at once,
// as a gap of that size is closed at once: shares of shares would never end, and nothing would come to rest
// meanwhile. Two take the share there, too: new contacts, since a large heap that starts without impulses is
// hard enough to solve; and high heaps, which would be thrown up.
double pushed_way(double overlap, bool at_once) {
  const double share = kPushShare * overlap;
  return at_once ? std::min(overlap, std::max(share, kSurfaceLayerM)) : share;
}

// Depths are only known to rounding. The corners of a face would otherwise ask for motions that contradict
// each other by the rounding over h, and their impulses would drift apart.
constexpr double kDepthNoiseM = 1e-9;

// The depth without its noise.
double beyond_noise(double depth) {
  return depth - std::clamp(depth, -kDepthNoiseM, kDepthNoiseM);
}

}  // namespace

double Bounded::velocity(std::size_t mechanism, const MechanismRow& row) const {
  if (row.axis != nullptr) return plant_.rate(*row.axis);
  const Bodies& bodies = plant_.bodies;
  double sum = 0.0;
  if (row.line.node_a >= 0) {
    const auto a = static_cast<std::size_t>(
        plant_.mechanisms[mechanism].body(static_cast<std::size_t>(row.line.node_a)));
    sum += row.line.angular_a.dot(bodies.w[a]) + row.line.linear_a.dot(bodies.v[a]);
  }
  if (row.line.node_b >= 0) {
    const auto b = static_cast<std::size_t>(
        plant_.mechanisms[mechanism].body(static_cast<std::size_t>(row.line.node_b)));
    sum += row.line.angular_b.dot(bodies.w[b]) + row.line.linear_b.dot(bodies.v[b]);
  }
  return sum;
}

void Bounded::load_velocities() {
  // Bodies without joints: six numbers each, angular before linear. Mechanisms: one number for each row.
  double* to = velocities_.data();
  for (const std::size_t body : slotted_) {
    const Vector3d &w = plant_.bodies.w[body], &v = plant_.bodies.v[body];
    to = std::copy(v.data(), v.data() + 3, std::copy(w.data(), w.data() + 3, to));
  }
  for (const std::size_t m : mechanisms())
    for (const MechanismRow& row : rows_of(m).rows) *to++ = velocity(m, row);
}

void Bounded::store_velocities() {
  // Bodies without joints take their velocities as they are.
  const double* from = velocities_.data();
  for (const std::size_t body : slotted_) {
    plant_.bodies.w[body] = Vector3d(from[0], from[1], from[2]);
    plant_.bodies.v[body] = Vector3d(from[3], from[4], from[5]);
    from += 6;
  }
  if (!responses_.empty()) push_mechanisms();
}

// Mechanisms get the change of each row's impulse, and answer it with all their joints.
void Bounded::push_mechanisms() {
  for (const std::size_t m : mechanisms())
    if (binds(m)) plant_.mechanisms[m].clear();
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const RowBlock& block = blocks_[k];
    for (std::size_t e = 0; e < block.end_count; ++e) {
      if (block.ends[e].free) continue;
      const std::size_t m = block.ends[e].mechanism;
      for (std::size_t i = 0; i < block.dim; ++i) {
        const MechanismRow& row = rows_of(m).rows[block.ends[e].first + i];
        const double impulse = block.lambda[i] - before_[k][i];
        if (row.axis != nullptr)
          plant_.mechanisms[m].tree().push_axis(static_cast<std::size_t>(row.axis->node), impulse);
        else
          plant_.mechanisms[m].push(row.line, impulse);
      }
    }
  }
  Bodies& bodies = plant_.bodies;
  for (const std::size_t m : mechanisms()) {
    if (!binds(m)) continue;
    work_.take(plant_.mechanisms[m].units());
    plant_.mechanisms[m].solve();
    moment_ == kAhead ? plant_.mechanisms[m].apply_ahead(bodies) : plant_.mechanisms[m].apply(bodies);
    take_axis_impulses(plant_, m, moment_);
  }
}

void Bounded::aim_touch(RowBlock& block, const Touch& touch, double bounce) const {
  block.friction = touch.friction;
  block.low = 0.0;
  const double layer = touch.yields ? kYieldingLayerM : kSurfaceLayerM;
  const double yield = touch.yields ? kYield / h_ : 0.0;
  // Only a body of another engine makes the contact yield. Its velocity, or that of a kinematic body, is part
  // of the target.
  Eigen::Map<Vector3d> target(block.target.data());
  target.setZero();
  if (!touch.foreign.isZero(0.0)) target -= touch.frame.transpose() * touch.foreign;
  block.compliance = moment_ == kAhead ? 2.0 * yield : yield;
  switch (moment_) {
    case kHit:
      // To the bounce that is asked of a hit.
      target[0] += bounce * touch.bounce;
      return;
    case kAhead: {
      target -= 0.5 * h_ * (touch.frame.transpose() * touch.bias);
      // Lets the bodies sink into the layer, or drives them out of an overlap.
      const double beyond = beyond_noise(touch.depth - layer);
      const double overlap = std::max(0.0, beyond - touch.landed);
      const bool at_once = at_once_ && touch.record != TouchEnds::kNew;
      const double way = beyond < 0.0 ? beyond : pushed_way(overlap, at_once);
      target[0] += std::min(way / h_, apart_ ? 0.0 : kMostPush);
      return;
    }
    default:
      // The impulses at t count for the friction cone, and P2 may take back P1.
      Eigen::Map<Vector3d>(block.base.data()) = touch.impulse[kHit] + touch.impulse[kAhead];
      target[0] -= yield * block.base[0];
      block.low = -touch.impulse[kAhead][0];
  }
}

// Asks for no relative rotation; the impulses of the moments before count for the bounds.
void Bounded::aim_twist(RowBlock& block, const Touch& touch) const {
  const Vector3d foreign = touch.frame.transpose() * touch.foreign_turn;
  for (std::size_t i = 0; i < 3; ++i) {
    const int k = static_cast<int>(i);
    block.target[i] = -foreign[k];
    if (moment_ == kAfter) block.base[i] = touch.twist[kHit][k] + touch.twist[kAhead][k];
  }
}

// The law's equations are in axes.cc.
void Bounded::aim_law(RowBlock& block, const Axis& axis) const {
  const double k = axis.compliance_s / h_, before = axis.law[kHit] + axis.law[kAhead];
  block.compliance = k;
  if (moment_ == kAhead) {
    block.target[0] = 0.5 * (axis.target + axis.rate) - 0.5 * k * axis.law[kHit] - axis.bias;
    block.high = 0.5 * h_ * axis.most;
    block.low = -block.high;
  } else {
    block.target[0] = axis.target - k * before;
    block.high = h_ * axis.most - before;
    block.low = -h_ * axis.most - before;
  }
}

// Damping is a law with the target 0 and no limit.
void Bounded::aim_damping(RowBlock& block, const Axis& axis) const {
  block.compliance = 1.0 / (axis.damping * h_);
  block.target[0] = moment_ == kAhead ? 0.5 * axis.rate - axis.bias
                                      : -block.compliance * (axis.damped[kHit] + axis.damped[kAhead]);
  block.low = -kInfinite;
  block.high = kInfinite;
}

// A stop is like a contact's normal. Upper stop: q~ <= room/h, impulse <= 0; the lower one is its mirror
// image.
void Bounded::aim_stop(RowBlock& block, const Axis& axis, std::size_t side) const {
  const double sign = side == 0 ? -1.0 : 1.0;
  // At the end of the step the stop may take back what it gave at t.
  const double taken_back = moment_ == kAfter ? -axis.stopped[side][kAhead] : 0.0;
  (side == 0 ? block.low : block.high) = taken_back;
  (side == 0 ? block.high : block.low) = -sign * kInfinite;
  switch (moment_) {
    case kHit:
      block.target[0] = -axis.model->stop_restitution * axis.rate;
      return;
    case kAhead: {
      const double left = room(axis, side);
      block.target[0] =
          sign * std::max((left > 0.0 ? 1.0 : kPushShare) * left / h_, apart_ ? 0.0 : -kMostPush) - axis.bias;
      return;
    }
    default:
      block.target[0] = 0.0;
  }
}

// The law of springs is in springs.cc.
void Bounded::aim_spring(RowBlock& block, const Spring& spring) const {
  const world::Joint& joint = *spring.spec.model;
  const double grip = spring.grip(h_);
  const double bias = spring.mean_rate - rows_.velocity(block, 0);
  block.compliance = 2.0 / (h_ * grip);
  block.target[0] = -joint.stiffness * (spring.length - joint.rest) / grip - bias;
  block.low = -kInfinite;
  block.high = kInfinite;
}

void Bounded::aim() {
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    RowBlock& block = blocks_[k];
    const Owner& owner = owners_[k];
    switch (owner.of) {
      case Of::kTouch:
        aim_touch(block, plant_.touches[owner.index], moment_ == kHit ? shares_[k].now : 0.0);
        break;
      case Of::kTwist:
        aim_twist(block, plant_.touches[owner.index]);
        break;
      case Of::kLaw:
        aim_law(block, plant_.axes[owner.index]);
        break;
      case Of::kDamping:
        aim_damping(block, plant_.axes[owner.index]);
        break;
      case Of::kStop:
        aim_stop(block, plant_.axes[owner.index], owner.side);
        break;
      case Of::kSpring:
        aim_spring(block, plant_.springs[owner.index]);
        break;
    }
  }
}

// If the look-ahead changed anything, the end of the step must be solved too. A small rest would otherwise
// stay, and the next look-ahead would have to change it back.
double Bounded::solve_rows() {
  load_velocities();
  for (std::size_t k = 0; k < blocks_.size(); ++k) before_[k] = blocks_[k].applied;
  const bool alone = responses_.empty();
  const double share = moment_ == kHit ? 0.0 : alone ? kShare : kMechanismShare;
  // A tick that stops a body starts the next one with half of that impulse too much. Left alone, this would
  // move the body, be answered, and so on for ever. It therefore has to be solved once more: a body that has
  // moved gets the smaller bound kComesToRest.
  const Rest last = moment_ == kAfter ? Rest{course_->rests, course_->still_before} : last_rest();
  course_->still_before = last.still;
  const double rest = last.rested ? 1.0 : moment_ == kAfter ? 0.0 : kComesToRest;
  const bool may_be_still = moment_ != kHit && !is_dragged();
  const double slow = may_be_still ? kFrozenShare * plant_.model.gravity.norm() * std::abs(h_) : 0.0;
  const bool may_freeze = last.still == kStillSteps && (moment_ == kAhead || course_->frozen);
  system_.freezes_below = may_freeze ? slow : 0.0;
  const Vector3d standing = moment_ == kAhead ? thrown_up(plant_.model.gravity, h_) : Vector3d::Zero();
  std::copy(standing.data(), standing.data() + 3, system_.still.begin() + 3);
  double missed = 0.0;
  bool still = false;
  try {
    if (course_->gently || apart_) {
      missed = rows_.sweep_gently(kGentleSweeps);
    } else {
      missed = rows_.solve(kMostSweeps, kEnough, share, rest);
      if (alone && !system_.frozen && rows_.is_still(kNearlyStill * slow)) rows_.polish(kEnough);
    }
    still = alone && rows_.is_still(slow);
  } catch (const WorkSpent&) {
    report();  // the best that was reached
    throw;
  }
  note_rest(still);
  if (system_.changed) store_velocities();
  return missed;
}

void Bounded::start_gently(std::span<const Vector3d> v, std::span<const Vector3d> w) {
  course_->gently = true;
  for (const std::size_t i : slotted_) {
    plant_.bodies.v[i] = v[i];
    plant_.bodies.w[i] = w[i];
  }
  for (RowBlock& block : blocks_) block.lambda = block.applied = {};
  rows_.soften(kGentleSoftness);
}

double Bounded::solve() {
  if (plant_.has_loose_springs(island_)) load_velocities();
  aim();
  return solve_rows();
}

// Only mechanisms can be so stiff that nothing moves a row.
bool Bounded::misses_where_stuck(double enough) const {
  if (system_.movable) return false;
  return std::ranges::any_of(blocks_, [&](const RowBlock& block) {
    if (!is_rigid(block)) return false;
    double missing = block.target[0];
    for (std::size_t e = 0; e < block.end_count; ++e) {
      const RowEnd& end = block.ends[e];
      if (!end.free) missing -= velocity(end.mechanism, rows_of(end.mechanism).rows[end.first]);
    }
    if (block.kind != RowBlock::Kind::kBounded) return missing > enough;  // it only pushes
    return missing > 0.0 ? missing > enough && block.lambda[0] < block.high
                         : missing < -enough && block.lambda[0] > block.low;
  });
}

void Bounded::find_short(double enough, std::vector<std::size_t>& found) {
  load_velocities();  // joints may have moved the bodies since
  for (const RowBlock& block : blocks_) {
    if (rows_.miss(block) <= enough) continue;
    for (std::size_t e = 0; e < block.end_count; ++e) found.push_back(slotted_[block.ends[e].offset / 6]);
  }
}

// Poisson's law brings everything to rest first. Newton's asks for the whole bounce, then looks at the
// energy.
void Bounded::bounce() {
  const bool poisson = plant_.setting.impact == "poisson";
  load_velocities();
  met_.resize(blocks_.size());
  shares_.assign(blocks_.size(), Share{.now = poisson ? 0.0 : 1.0});
  for (std::size_t k = 0; k < blocks_.size(); ++k)
    for (std::size_t row = 0; row < blocks_[k].dim; ++row) met_[k][row] = rows_.velocity(blocks_[k], row);
  solve();
  poisson ? restore_by_poisson() : keep_energy();
}

// J, mean of the velocities before and after times the impulse; 0 where it is no more than rounding.
double Bounded::work(std::size_t k) const {
  const RowBlock& block = blocks_[k];
  double work = 0.0, size = 0.0;
  for (std::size_t i = 0; i < block.dim; ++i) {
    const double now = rows_.velocity(block, i);
    work += 0.5 * block.lambda[i] * (met_[k][i] + now);
    size += 0.5 * std::abs(block.lambda[i]) * (std::abs(met_[k][i]) + std::abs(now));
  }
  return work > kSameEnergy * size ? work : 0.0;
}

// Finds, for each contact by itself, the largest share of the bounce that gains no energy, by halving the
// interval.
void Bounded::keep_energy() {
  for (int cut = 0; cut <= kMostCuts; ++cut) {
    bool changed = false;
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      if (owners_[k].of != Of::kTouch || plant_.touches[owners_[k].index].bounce == 0.0) continue;
      Share& share = shares_[k];
      const double now = share.now;
      (work(k) > 0.0 ? share.most : share.least) = now;
      share.now =
          cut == kMostCuts || share.least == share.most ? share.least : 0.5 * (share.least + share.most);
      changed = changed || share.now != now;
    }
    if (!changed) return;
    solve();
  }
}

// The second half of the hit: at least (1 + e) of the impulse of the first half.
void Bounded::restore_by_poisson() {
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const Owner& owner = owners_[k];
    if (owner.of != Of::kTouch) continue;
    blocks_[k].low = (1.0 + plant_.touches[owner.index].returned) * blocks_[k].lambda[0];
  }
  solve_rows();
}

void Bounded::report() {
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const std::array<double, 3>& lambda = blocks_[k].lambda;
    const Owner& owner = owners_[k];
    switch (owner.of) {
      case Of::kTouch:
        plant_.touches[owner.index].impulse[moment_] = Vector3d(lambda[0], lambda[1], lambda[2]);
        break;
      case Of::kTwist:
        plant_.touches[owner.index].twist[moment_] = Vector3d(lambda[0], lambda[1], lambda[2]);
        break;
      case Of::kLaw:
        plant_.axes[owner.index].law[moment_] = lambda[0];
        break;
      case Of::kDamping:
        plant_.axes[owner.index].damped[moment_] = lambda[0];
        break;
      case Of::kStop:
        plant_.axes[owner.index].stopped[owner.side][moment_] = lambda[0];
        break;
      case Of::kSpring:
        plant_.springs[owner.index].impulse = lambda[0];
        break;
    }
  }
}

}  // namespace visum::dynamics::impulse
