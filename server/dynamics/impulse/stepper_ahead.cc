// How a step finds the impulses at t: it looks ahead, and closes the gaps that open there.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/dynamics/impulse/stepper.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kPushed = 1.0;  // m, rad: stands for the gap while a drive's push has not been looked at yet
constexpr double kLawShare =
    1e-3;  // share of d_max that a drive's law may miss over a step without a solution
constexpr double kUntouched = 0.17;   // share of d_max: a smaller gap after the prediction is left as it is
constexpr double kFar = 1e-3;         // m, rad: beyond such a gap the prediction is of no use
constexpr double kApart = 3e-5;       // m, rad: a joint farther apart is broken, if shorter steps do not help
constexpr int kGentlePasses = 5;      // passes in which contacts take part
constexpr double kRounding = 2.0;     // share of d_max: a gap of rounding, which is let be
constexpr double kStandstill = 1e-9;  // m, rad: a smaller gap that no longer shrinks is rounding

}  // namespace

void Stepper::fly(std::size_t m, double h) {
  if (iterates_) return corrector_->look_ahead(m, h);
  plant_.bodies.look_ahead(plant_.mechanisms[m].blocks(), h, plant_.model.gravity);
}

// Gives what the joints and drives gave in the last steps, carried on. Returns false where too little is
// known.
bool Stepper::predict(std::size_t m, double h) {
  Mechanism& mechanism = plant_.mechanisms[m];
  if (!mechanism.predict(plant_.bodies)) return false;
  for (Axis& axis : plant_.acting_axes_of(m)) {
    if (axis.node < 0) continue;  // push() has pushed it
    const auto node = static_cast<std::size_t>(axis.node);
    const double known = known_impulse(axis, kAhead, h);
    // A law in the tree gets what was predicted on its axis; otherwise the known impulse alone is given.
    const double impulse = is_in_tree(axis) ? mechanism.predicted_axis(node) : known;
    if (is_in_tree(axis)) take_law_impulse(axis, kAhead, impulse - known);
    if (impulse != 0.0) mechanism.push_predicted_axis(node, impulse);
  }
  mechanism.give_predicted(plant_.bodies);
  return true;
}

void Stepper::take_back(std::size_t m, double h) {
  Mechanism& mechanism = plant_.mechanisms[m];
  for (std::size_t i = 0; i < mechanism.size(); ++i) {
    const auto body = static_cast<std::size_t>(mechanism.body(i));
    plant_.bodies.v[body] = unpushed_v_[body];
    plant_.bodies.w[body] = unpushed_w_[body];
  }
  mechanism.begin_step(h);
  for (Axis& axis : plant_.acting_axes_of(m)) axis.law[kAhead] = axis.damped[kAhead] = 0.0;
}

// Gap of the look-ahead, and the request to the tree that would close it.
double Stepper::find_gap(std::size_t m, double h, const world::WorldState& state, double law_share) {
  Mechanism& mechanism = plant_.mechanisms[m];
  plant_.work.take(mechanism.units());
  fly(m, h);
  mechanism.clear();
  const double gap = mechanism.ask_gaps(plant_.bodies, state, h);
  measure_ahead(plant_, m, h);
  const double missing = h * ask_axes(plant_, m, kAhead, h) / law_share;
  return missing > gap || std::isnan(missing) ? missing : gap;
}

void Stepper::give_answer(std::size_t m, Moment moment) {
  Mechanism& mechanism = plant_.mechanisms[m];
  mechanism.solve();
  if (moment == kAhead)
    mechanism.apply_ahead(plant_.bodies);
  else
    mechanism.apply_after(plant_.bodies);
  take_axis_impulses(plant_, m, moment);
}

// The rest is below the product of the answer's change and the angle that a body turns in a step, taken twice
// because the levers of both bodies turn.
double Stepper::left_by_answer(std::size_t m, double h) const {
  const Mechanism& mechanism = plant_.mechanisms[m];
  return 4.0 * h * h * mechanism.largest_answer() * mechanism.largest_turn(plant_.bodies);
}

void Stepper::nudge(std::size_t m, double h) {
  const Mechanism& mechanism = plant_.mechanisms[m];
  mechanism.nudge(plant_.bodies, h);
  for (Axis& axis : plant_.acting_axes_of(m))
    axis.mean_rate += mechanism.tree().axis_rate(static_cast<std::size_t>(axis.node));
}

// True if the look-ahead may follow the mechanism's answers. An axis that closes a loop is not in the tree's
// answer, and near a pose where loops lose their grip an answer leaves more than left_by_answer() says.
bool Stepper::may_follow(std::size_t m) const {
  for (const Axis& axis : plant_.acting_axes_of(m))
    if (axis.node < 0) return false;
  return plant_.mechanisms[m].is_foreseeable();
}

bool Stepper::follow_answer(std::size_t m, double h) {
  double& left = left_[m];
  left += left_by_answer(m, h);
  if (!may_follow(m)) left = std::numeric_limits<double>::infinity();
  if (!(left <= d_max(m))) return false;
  nudge(m, h);
  return true;
}

// The first pass includes the drives' known impulses.
double Stepper::find_gap_of_pass(std::size_t m, double h, const world::WorldState& state, int pass) {
  const double largest = find_gap(m, h, state, 1.0);
  return pass == 0 && push_known(m, kAhead, h) ? std::max(largest, kPushed) : largest;
}

// One pass of Newton over a mechanism's joints. Returns the gap that it found; below d_max it does nothing.
double Stepper::close(std::size_t m, double h, const world::WorldState& state, int pass) {
  const double largest = find_gap_of_pass(m, h, state, pass);
  if (!(largest <= d_max(m))) give_answer(m, kAhead);
  return largest;
}

// Newton's passes. Returns false where the joints do not close.
bool Stepper::close_by_newton(std::size_t m, double h, const world::WorldState& state, bool foreseen) {
  const bool has_loops = plant_.mechanisms[m].loop_count() > 0;
  double last = 0.0;
  for (int pass = foreseen ? 1 : 0; pass < bounds_.most_passes; ++pass) {
    const double gap = find_gap_of_pass(m, h, state, pass);
    if (gap <= d_max(m)) return true;
    if (!std::isfinite(gap)) return false;
    const bool stands = pass > 2 && gap <= kStandstill && gap > 0.5 * last;
    // A tiny gap that no longer shrinks is rounding. With loops, which may be about to lose their grip, one
    // more answer may open it again, and a shorter step may help.
    if (stands && has_loops) {
      if (divisible_ && gap > kRounding * d_max(m)) return false;
      fell_short_ = true;
      return true;
    }
    give_answer(m, kAhead);
    if (stands) {
      fell_short_ = true;
      fly(m, h);
      return true;
    }
    last = gap;
  }
  return false;
}

// Corrects the prediction. If the answer changes the look-ahead by little, the look-ahead is changed to first
// order instead of being flown again. Returns false where the prediction is of no use.
bool Stepper::close_foreseen(std::size_t m, double h, const world::WorldState& state) {
  const double gap = find_gap(m, h, state, kLawShare);
  if (gap <= kUntouched * d_max(m)) return true;
  if (!(gap <= kFar)) return false;
  give_answer(m, kAhead);
  if (!may_follow(m) || !(left_by_answer(m, h) <= d_max(m))) return close_by_newton(m, h, state, true);
  nudge(m, h);
  return true;
}

// Notes the worst joint, and returns false for the caller to pass on.
bool Stepper::break_at(std::size_t m) {
  broken_ = worst_joint(m);
  broken_mechanism_ = m;
  return false;
}

// Starts from the prediction. Without one, or where it leads nowhere, starts from zero.
bool Stepper::close_alone(std::size_t m, double h, const world::WorldState& state) {
  if (iterates_) return correct_alone(m, h, state);
  if (predict(m, h)) {
    if (close_foreseen(m, h, state)) return true;
    take_back(m, h);
  }
  return close_by_newton(m, h, state, false) || break_at(m);
}

// One correction of each joint. Rows that act on the mechanism need to know where it leads.
double Stepper::correct(std::size_t m, double h, const world::WorldState& state, int sweep) {
  plant_.work.take(plant_.mechanisms[m].units());
  const double gap = corrector_->sweep_gaps(m, h, bounds_.d_max, state, sweep);
  if (bounded_.binds(m)) {
    fly(m, h);
    plant_.mechanisms[m].ask_gaps(plant_.bodies, state, h);
    measure_ahead(plant_, m, h);
  }
  return gap;
}

// If the budget is spent, the rest of the gap is left to the next step.
bool Stepper::correct_alone(std::size_t m, double h, const world::WorldState& state) {
  corrector_->forget_look_ahead(m);
  double gap = 2.0 * bounds_.d_max;
  for (int sweep = 0; sweep < bounds_.most_passes && gap > bounds_.d_max; ++sweep)
    gap = correct(m, h, state, sweep);
  fly(m, h);
  fell_short_ = fell_short_ || gap > bounds_.d_max;
  return std::isfinite(gap) || break_at(m);
}

void Stepper::look_at_springs(std::size_t island, double h, const world::WorldState& state) {
  const std::span<const std::size_t> springs = plant_.islands.springs(island);
  if (springs.empty()) return;
  for (const std::size_t i : bounded_.free_bodies(island))
    plant_.bodies.look_ahead(plant_.bodies.block_of(i), h, plant_.model.gravity);
  measure_springs_ahead(plant_, springs, state, h);
}

double Stepper::close_joints(std::size_t island, double h, const world::WorldState& state, int pass,
                             bool& closed, Fate& fate) {
  double largest = 0.0;
  closed = true;
  for (const std::size_t m : plant_.islands.mechanisms(island)) {
    if (!bounded_.binds(m)) continue;
    if (iterates_) corrector_->forget_look_ahead(m);
    const double gap = iterates_ ? correct(m, h, state, pass) : close(m, h, state, pass);
    if (!iterates_) {
      left_[m] = 0.0;
      // An answer that cannot be followed stays in left_, so that follow_rows() fails, too.
      if (!(gap <= d_max(m))) follow_answer(m, h);
    }
    closed = closed && gap <= d_max(m);
    if (gap <= largest || std::isnan(largest)) continue;
    largest = gap;
    fate.broken = worst_joint(m);
    fate.mechanism = m;
  }
  return largest;
}

bool Stepper::follow_rows(std::size_t island, double h) {
  const bool changed = bounded_.has_changed(island);
  bool followed = true;
  for (const std::size_t m : plant_.islands.mechanisms(island))
    if (bounded_.binds(m)) followed = (changed ? follow_answer(m, h) : left_[m] <= d_max(m)) && followed;
  return followed;
}

// Alternates Newton's passes over the joints of an island's mechanisms with rows, and solutions of the rows.
// A further pass is not needed where joints and rows have been answered and the answers' own rest, of second
// order, is next to nothing: the look-ahead has then followed them.
Stepper::Closed Stepper::close_with_rows(std::size_t island, double h, const world::WorldState& state,
                                         bool gently, Fate& fate) {
  double largest = 0.0, moved = 0.0;
  bool closed = false;
  // The lengths of springs are known of a flight only.
  const bool may_follow = !gently && !iterates_ && plant_.islands.springs(island).empty();
  for (int pass = 0; pass < bounds_.most_passes; ++pass) {
    // The joints first; the worst one is noted in case nothing closes.
    largest = close_joints(island, h, state, pass, closed, fate);
    if (!std::isfinite(largest)) return Closed::kNo;
    // Then springs and rows, with the bodies where the joints have brought them. `moved`: m or rad by which
    // the rows moved them.
    look_at_springs(island, h, state);
    moved = gently && pass >= kGentlePasses ? 0.0 : std::abs(h) * bounded_.solve(island, fate.worker);
    if (!std::isfinite(moved)) return Closed::kNo;
    fate.followed = may_follow && follow_rows(island, h);
    if (fate.followed && bounded_.is_solved(island)) return Closed::kYes;
    if (closed && (gently || moved <= bounds_.d_max)) return Closed::kYes;
  }
  // The passes are used up: what is near enough goes on, unless shorter steps may do better.
  const double most = divisible_ ? 0.0 : kApart;
  return iterates_ || (moved <= kApart && (closed || largest <= most)) ? Closed::kNearly : Closed::kNo;
}

// For mechanisms that share contacts or have bounds of their own. Contacts that wedge joints may have no
// answer, or only impulses that push against each other without limit. The second try then takes what comes
// near an answer.
bool Stepper::close_together(std::size_t island, double h, const world::WorldState& state, Fate& fate) {
  const std::span<const std::size_t> mechanisms = plant_.islands.mechanisms(island);
  Closed closed = close_with_rows(island, h, state, false, fate);
  if (closed == Closed::kNo && fate.broken != nullptr && has_laws_to_box(fate.mechanism)) return false;
  if (closed == Closed::kNo && !iterates_) {
    for (const std::size_t m : mechanisms)
      if (bounded_.binds(m)) take_back(m, h);
    bounded_.start_gently(island, unpushed_v_, unpushed_w_);
    closed = close_with_rows(island, h, state, true, fate);
    fate.fell_short = true;
  }
  if (closed == Closed::kNo) return false;
  fate.fell_short = fate.fell_short || closed == Closed::kNearly;
  if (fate.followed) return true;
  // Brings the look-ahead up to date with the last impulses.
  for (const std::size_t m : mechanisms) {
    if (!bounded_.binds(m)) continue;
    if (iterates_) corrector_->forget_look_ahead(m);
    fly(m, h);
  }
  return true;
}

void Stepper::note(const Fate& fate) {
  broken_ = fate.broken;
  broken_mechanism_ = fate.mechanism;
  fell_short_ = fell_short_ || fate.fell_short;
}

bool Stepper::look_ahead(double h, const world::WorldState& state) {
  // Kept for take_back().
  if (!iterates_) {
    copy(plant_.bodies.v, unpushed_v_);
    copy(plant_.bodies.w, unpushed_w_);
  }
  // Mechanisms without rows are closed one by one, the others by islands; then everything without joints
  // flies.
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m)
    if (!plant_.mechanism_asleep[m] && !bounded_.binds(m) && !close_alone(m, h, state)) return false;
  fates_.assign(plant_.islands.size(), {});
  left_.resize(plant_.mechanisms.size());
  const bool closed = for_islands([&](std::size_t worker, std::size_t island) {
    fates_[island] = {.tried = true, .worker = worker};
    return close_together(island, h, state, fates_[island]);
  });
  for (std::size_t island = 0; island < fates_.size(); ++island)
    if (fates_[island].tried) note(fates_[island]);
  if (!closed) return false;
  plant_.for_free([&](auto blocks) { plant_.bodies.look_ahead(blocks, h, plant_.model.gravity); });
  return true;
}

}  // namespace visum::dynamics::impulse
