// How an island's step finds the impulses at t: it looks ahead, and closes the gaps that open there.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/dynamics/impulse/island_stepper.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kPushed = 1.0;  // m, rad: stands for the gap while a drive's push has not been looked at yet
constexpr double kLawShare =
    1e-3;  // share of d_max that a drive's law may miss over a step without a solution
constexpr double kUntouched = 0.17;   // share of d_max: a smaller gap after the prediction is left as it is
constexpr double kFar = 1e-3;         // m, rad: beyond such a gap the prediction is of no use
constexpr double kApart = 3e-5;       // m, rad: a joint farther apart is broken, if shorter steps do not help
constexpr int kGentlePasses = 5;      // passes in which contacts take part
constexpr double kNearer = 0.9;       // a pass that leaves more than this share of the best one is no nearer
constexpr int kMostFutile = 8;        // passes that come no nearer
constexpr double kRounding = 2.0;     // share of d_max: a gap of rounding, which is let be
constexpr double kStandstill = 1e-9;  // m, rad: a smaller gap that no longer shrinks is rounding

}  // namespace

void IslandStepper::fly(std::size_t m) {
  if (plan_.iterates) return corrector().look_ahead(m, plan_.h);
  plant_.bodies.look_ahead(plant_.mechanisms[m].blocks(), plan_.h, plant_.model.gravity);
}

// Gives what the joints and drives gave in the last steps, carried on. Returns false where too little is
// known.
bool IslandStepper::predict(std::size_t m) {
  Mechanism& mechanism = plant_.mechanisms[m];
  if (!mechanism.predict(plant_.bodies)) return false;
  for (Axis& axis : plant_.acting_axes_of(m)) {
    if (axis.node < 0) continue;  // push() has pushed it
    const auto node = static_cast<std::size_t>(axis.node);
    const double known = known_impulse(axis, kAhead, plan_.h);
    // A law in the tree gets what was predicted on its axis; otherwise the known impulse alone is given.
    const bool in_tree = is_in_tree(axis, kAhead);
    const double impulse = in_tree ? mechanism.predicted_axis(node) : known;
    if (in_tree) take_law_impulse(axis, kAhead, impulse - known);
    if (impulse != 0.0) mechanism.push_predicted_axis(node, impulse);
  }
  mechanism.give_predicted(plant_.bodies);
  return true;
}

void IslandStepper::take_back(std::size_t m) {
  Mechanism& mechanism = plant_.mechanisms[m];
  for (std::size_t i = 0; i < mechanism.size(); ++i) {
    const auto body = static_cast<std::size_t>(mechanism.body(i));
    plant_.bodies.v[body] = kept_.unpushed_v[body];
    plant_.bodies.w[body] = kept_.unpushed_w[body];
  }
  mechanism.begin_step(plan_.h);
  for (Axis& axis : plant_.acting_axes_of(m)) axis.law[kAhead] = axis.damped[kAhead] = 0.0;
}

// Gap of the look-ahead, and the request to the tree that would close it.
double IslandStepper::find_gap(std::size_t m, double law_share) {
  Mechanism& mechanism = plant_.mechanisms[m];
  work_.take(mechanism.units());
  fly(m);
  mechanism.clear();
  const double gap = mechanism.ask_gaps(plant_.bodies, state(), plan_.h);
  measure_ahead(plant_, m, plan_.h);
  const double missing = std::abs(plan_.h) * ask_axes(plant_, m, kAhead, plan_.h) / law_share;
  return missing > gap || std::isnan(missing) ? missing : gap;
}

void IslandStepper::give_answer(std::size_t m, Moment moment) {
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
double IslandStepper::left_by_answer(std::size_t m) const {
  const Mechanism& mechanism = plant_.mechanisms[m];
  return 4.0 * plan_.h * plan_.h * mechanism.largest_answer() * mechanism.largest_turn(plant_.bodies);
}

void IslandStepper::nudge(std::size_t m) {
  const Mechanism& mechanism = plant_.mechanisms[m];
  mechanism.nudge(plant_.bodies, plan_.h);
  for (Axis& axis : plant_.acting_axes_of(m))
    axis.mean_rate += mechanism.tree().axis_rate(static_cast<std::size_t>(axis.node));
}

// True if the look-ahead may follow the mechanism's answers. An axis that closes a loop is not in the tree's
// answer, and near a pose where loops lose their grip an answer leaves more than left_by_answer() says.
bool IslandStepper::may_follow(std::size_t m) const {
  for (const Axis& axis : plant_.acting_axes_of(m))
    if (axis.node < 0) return false;
  return plant_.mechanisms[m].is_foreseeable();
}

bool IslandStepper::follow_answer(std::size_t m) {
  double& left = kept_.left[m];
  left += left_by_answer(m);
  if (!may_follow(m)) left = std::numeric_limits<double>::infinity();
  if (!(left <= d_max(m))) return false;
  nudge(m);
  return true;
}

// The first pass includes the drives' known impulses.
double IslandStepper::find_gap_of_pass(std::size_t m, int pass) {
  const double largest = find_gap(m, 1.0);
  return pass == 0 && push_known(m, kAhead) ? std::max(largest, kPushed) : largest;
}

// One pass of Newton over a mechanism's joints. Returns the gap that it found; below d_max it does nothing.
double IslandStepper::close(std::size_t m, int pass) {
  const double largest = find_gap_of_pass(m, pass);
  if (!(largest <= d_max(m))) give_answer(m, kAhead);
  return largest;
}

// Newton's passes. Returns false where the joints do not close.
bool IslandStepper::close_by_newton(std::size_t m, bool foreseen) {
  const bool has_loops = plant_.mechanisms[m].loop_count() > 0;
  double last = 0.0;
  for (int pass = foreseen ? 1 : 0; pass < plan_.bounds.most_passes; ++pass) {
    const double gap = find_gap_of_pass(m, pass);
    if (gap <= d_max(m)) return true;
    if (!std::isfinite(gap)) return false;
    const bool stands = pass > 2 && gap <= kStandstill && gap > 0.5 * last;
    // A tiny gap that no longer shrinks is rounding. With loops, which may be about to lose their grip, one
    // more answer may open it again, and a shorter step may help.
    if (stands && has_loops) {
      if (plan_.divisible && gap > kRounding * d_max(m)) return false;
      fate_->fell_short = true;
      return true;
    }
    give_answer(m, kAhead);
    if (stands) {
      fate_->fell_short = true;
      fly(m);
      return true;
    }
    last = gap;
  }
  return false;
}

// Corrects the prediction. If the answer changes the look-ahead by little, the look-ahead is changed to first
// order instead of being flown again. Returns false where the prediction is of no use.
bool IslandStepper::close_foreseen(std::size_t m) {
  const double gap = find_gap(m, kLawShare);
  if (gap <= kUntouched * d_max(m)) return true;
  if (!(gap <= kFar)) return false;
  give_answer(m, kAhead);
  if (!may_follow(m) || !(left_by_answer(m) <= d_max(m))) return close_by_newton(m, true);
  nudge(m);
  return true;
}

// Notes the worst joint, and returns false for the caller to pass on.
bool IslandStepper::break_at(std::size_t m) {
  fate_->broken = worst_joint(m);
  fate_->mechanism = m;
  return false;
}

// Starts from the prediction. Without one, or where it leads nowhere, starts from zero.
bool IslandStepper::close_alone(std::size_t m) {
  if (plan_.iterates) return correct_alone(m);
  if (predict(m)) {
    if (close_foreseen(m)) return true;
    take_back(m);
  }
  return close_by_newton(m, false) || break_at(m);
}

// One correction of each joint. Rows that act on the mechanism need to know where it leads.
double IslandStepper::correct(std::size_t m, int sweep) {
  work_.take(plant_.mechanisms[m].units());
  const double gap = corrector().sweep_gaps(m, plan_.h, plan_.bounds.d_max, state(), sweep);
  if (bounded_.binds(m)) {
    fly(m);
    plant_.mechanisms[m].ask_gaps(plant_.bodies, state(), plan_.h);
    measure_ahead(plant_, m, plan_.h);
  }
  return gap;
}

// If the budget is spent, the rest of the gap is left to the next step.
bool IslandStepper::correct_alone(std::size_t m) {
  corrector().forget_look_ahead(m);
  double gap = 2.0 * plan_.bounds.d_max;
  for (int sweep = 0; sweep < plan_.bounds.most_passes && gap > plan_.bounds.d_max; ++sweep)
    gap = correct(m, sweep);
  fly(m);
  fate_->fell_short = fate_->fell_short || gap > plan_.bounds.d_max;
  return std::isfinite(gap) || break_at(m);
}

void IslandStepper::look_at_springs() {
  if (!plant_.has_loose_springs(island_)) return;
  for (const std::size_t i : bounded_.free_bodies())
    plant_.bodies.look_ahead(plant_.bodies.block_of(i), plan_.h, plant_.model.gravity);
  measure_springs_ahead(plant_, island_, state(), plan_.h);
}

double IslandStepper::close_joints(int pass, bool& closed) {
  double largest = 0.0;
  closed = true;
  for (const std::size_t m : mechanisms()) {
    if (!bounded_.binds(m)) continue;
    if (plan_.iterates) corrector().forget_look_ahead(m);
    const double gap = plan_.iterates ? correct(m, pass) : close(m, pass);
    if (!plan_.iterates) {
      kept_.left[m] = 0.0;
      // An answer that cannot be followed stays in left_, so that follow_rows() fails, too.
      if (!(gap <= d_max(m))) follow_answer(m);
    }
    closed = closed && gap <= d_max(m);
    if (gap <= largest || std::isnan(largest)) continue;
    largest = gap;
    fate_->broken = worst_joint(m);
    fate_->mechanism = m;
  }
  return largest;
}

bool IslandStepper::follow_rows() {
  const bool changed = bounded_.has_changed();
  bool followed = true;
  for (const std::size_t m : mechanisms())
    if (bounded_.binds(m)) followed = (changed ? follow_answer(m) : kept_.left[m] <= d_max(m)) && followed;
  return followed;
}

// Alternates Newton's passes over the joints of mechanisms with rows, and solutions of the rows. A further
// pass is not needed where joints and rows have been answered and the answers' own rest, of second order, is
// next to nothing: the look-ahead has then followed them.
IslandStepper::Closed IslandStepper::close_with_rows(bool gently) {
  double largest = 0.0, moved = 0.0, nearest = std::numeric_limits<double>::infinity();
  bool closed = false;
  int nearest_at = 0;
  // The lengths of springs are known of a flight only, but for those on axes.
  const bool may_follow = !gently && !plan_.iterates && !plant_.has_loose_springs(island_);
  for (int pass = 0; pass < plan_.bounds.most_passes; ++pass) {
    // The joints first; the worst one is noted in case nothing closes.
    largest = close_joints(pass, closed);
    if (!std::isfinite(largest)) return Closed::kNo;
    // Then springs and rows, with the bodies where the joints have brought them. `moved`: m or rad by which
    // the rows moved them.
    look_at_springs();
    moved = gently && pass >= kGentlePasses ? 0.0 : std::abs(plan_.h) * bounded_.solve();
    if (!std::isfinite(moved)) return Closed::kNo;
    if (minds_wedges_ && !gently && bounded_.mark_wedges()) {
      fate_->wedged = true;
      return Closed::kNo;
    }
    fate_->followed = may_follow && follow_rows();
    fate_->inexact = bounded_.is_inexact();
    if (fate_->followed && bounded_.is_solved()) return Closed::kYes;
    if (closed && fate_->inexact) return Closed::kNearly;
    if (closed && (gently || moved <= plan_.bounds.d_max)) return Closed::kYes;
    // Answers that take turns come no nearer.
    if (const double missing = std::max(largest, moved); missing < kNearer * nearest) {
      nearest = missing;
      nearest_at = pass;
    }
    if (!plan_.iterates && !gently && pass - nearest_at >= kMostFutile) break;
  }
  // The passes are used up: what is near enough goes on, unless shorter steps may do better.
  const double most = plan_.divisible ? 0.0 : kApart;
  return plan_.iterates || (moved <= kApart && (closed || largest <= most)) ? Closed::kNearly : Closed::kNo;
}

// For mechanisms that share contacts or have bounds of their own. Contacts that wedge joints may have no
// answer, or only impulses that push against each other without limit. The second try then takes what comes
// near an answer.
bool IslandStepper::close_together() {
  Closed closed = close_with_rows(false);
  if (fate_->wedged) return false;
  if (closed == Closed::kNo && fate_->broken != nullptr && has_laws_to_box(fate_->mechanism)) return false;
  if (closed == Closed::kNo && !plan_.iterates) {
    for (const std::size_t m : mechanisms())
      if (bounded_.binds(m)) take_back(m);
    bounded_.start_gently(kept_.unpushed_v, kept_.unpushed_w);
    closed = close_with_rows(true);
    fate_->fell_short = true;
  }
  if (closed == Closed::kNo) return false;
  fate_->fell_short = fate_->fell_short || closed == Closed::kNearly;
  if (fate_->followed) return true;
  // Brings the look-ahead up to date with the last impulses.
  for (const std::size_t m : mechanisms()) {
    if (!bounded_.binds(m)) continue;
    if (plan_.iterates) corrector().forget_look_ahead(m);
    fly(m);
  }
  return true;
}

bool IslandStepper::look_ahead() {
  fate_->broken = nullptr;
  fate_->followed = fate_->wedged = false;
  // Kept for take_back().
  if (!plan_.iterates) {
    copy(plant_.bodies.v, kept_.unpushed_v);
    copy(plant_.bodies.w, kept_.unpushed_w);
  }
  // Mechanisms without rows are closed one by one, the others together.
  for (const std::size_t m : mechanisms())
    if (!plant_.mechanism_asleep[m] && !bounded_.binds(m) && !close_alone(m)) return false;
  return !bounded_.has_rows() || close_together();
}

}  // namespace visum::dynamics::impulse
