// How a step finds the impulses at t: look ahead, and close what opens there.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/dynamics/impulse/stepper.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kPushed = 1.0;      // m, rad: where drives have pushed, the gap is not yet known
constexpr double kLawShare = 1e-3;   // of D_max, that a drive's law may miss over a step without a solution
constexpr double kUntouched = 0.17;  // of D_max: below such a gap of what was foreseen nothing is solved for
constexpr double kFar = 1e-3;        // m, rad: a gap of what was foreseen, beyond which it is of no use
constexpr double kApart = 3e-5;   // m, rad: beyond this it is broken, where shorter steps do not help, either
constexpr int kGentlePasses = 5;  // in which contacts have their say
constexpr double kRounding = 4.0;     // of D_max: a gap that does not, and is let be
constexpr double kStandstill = 1e-9;  // m, rad: a gap below, which no longer shrinks, is rounding

}  // namespace

void Stepper::fly(std::size_t m, double h) {
  if (corrector_) return corrector_->look_ahead(m, h);
  plant_.bodies.look_ahead(plant_.mechanisms[m].blocks(), h, plant_.model.gravity);
}

// What the joints and their drives gave in the last steps goes on; false where that is not known.
bool Stepper::predict(std::size_t m, double h) {
  Mechanism& mechanism = plant_.mechanisms[m];
  if (!mechanism.predict(plant_.bodies)) return false;
  for (Axis& axis : plant_.acting_axes_of(m)) {
    const auto node = static_cast<std::size_t>(axis.node);
    const double known = known_impulse(axis, kAhead, h);
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
  mechanism.prediction().begin(h);
  for (Axis& axis : plant_.acting_axes_of(m)) axis.law[kAhead] = axis.damped[kAhead] = 0.0;
}

// The gap that a look-ahead finds, asked of the tree.
double Stepper::find_gap(std::size_t m, double h, const world::WorldState& state, double law_share) {
  Mechanism& mechanism = plant_.mechanisms[m];
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

// One pass of Newton over a mechanism's joints, the first with what drives give. Returns the gap that it
// found; below D_max nothing is done.
double Stepper::close(std::size_t m, double h, const world::WorldState& state, int pass) {
  double largest = find_gap(m, h, state, 1.0);
  if (pass == 0 && push_known(m, kAhead, h)) largest = std::max(largest, kPushed);
  if (!(largest <= d_max(m))) give_answer(m, kAhead);
  return largest;
}

// Newton's passes. False where the joints do not close.
bool Stepper::close_by_newton(std::size_t m, double h, const world::WorldState& state, bool foreseen) {
  // Where loops lose their grip a shorter step may find it.
  const bool may_cut = divisible_ && plant_.mechanisms[m].loop_count() > 0;
  double last = 0.0;
  for (int pass = foreseen ? 1 : 0; pass < most_passes_; ++pass) {
    const double gap = close(m, h, state, pass);
    if (gap <= d_max(m)) return true;
    if (!std::isfinite(gap)) return false;
    if (pass > 2 && gap <= kStandstill && gap > 0.5 * last) {
      if (may_cut && gap > kRounding * d_max(m)) return false;
      fell_short_ = true;
      fly(m, h);
      return true;
    }
    last = gap;
  }
  return false;
}

// What was foreseen, and what it has missed. Where the answer changes the look-ahead by little, that is
// changed to first order: the rest is below the product of that change and what a body turns in a step, twice
// over for the turned levers of both bodies. False where nothing of it is of use.
bool Stepper::close_foreseen(std::size_t m, double h, const world::WorldState& state) {
  const double gap = find_gap(m, h, state, kLawShare);
  if (gap <= kUntouched * d_max(m)) return true;
  if (!(gap <= kFar)) return false;
  give_answer(m, kAhead);
  const Mechanism& mechanism = plant_.mechanisms[m];
  const double left = 4.0 * h * h * mechanism.largest_answer() * mechanism.largest_turn(plant_.bodies);
  if (!(std::abs(left) <= d_max(m))) return close_by_newton(m, h, state, true);
  mechanism.nudge(plant_.bodies, h);
  for (Axis& axis : plant_.acting_axes_of(m))
    axis.mean_rate += mechanism.tree().axis_rate(static_cast<std::size_t>(axis.node));
  return true;
}

// Returns false.
bool Stepper::break_at(std::size_t m) {
  broken_ = worst_joint(m);
  broken_mechanism_ = m;
  return false;
}

// From what is foreseen; from nothing where that is not known, or leads nowhere.
bool Stepper::close_alone(std::size_t m, double h, const world::WorldState& state) {
  if (corrector_) return correct_alone(m, h, state);
  if (predict(m, h)) {
    if (close_foreseen(m, h, state)) return true;
    take_back(m, h);
  }
  return close_by_newton(m, h, state, false) || break_at(m);
}

// One correction of each joint; what has bounds is told where that leads.
double Stepper::correct(std::size_t m, double h, const world::WorldState& state, int sweep) {
  const double gap = corrector_->sweep_gaps(m, h, d_max_, state, sweep);
  if (bounded_.binds(m)) {
    fly(m, h);
    plant_.mechanisms[m].ask_gaps(plant_.bodies, state, h);
    measure_ahead(plant_, m, h);
  }
  return gap;
}

// What is left when the budget is spent is left to the next step.
bool Stepper::correct_alone(std::size_t m, double h, const world::WorldState& state) {
  corrector_->forget_look_ahead(m);
  double gap = 2.0 * d_max_;
  for (int sweep = 0; sweep < most_passes_ && gap > d_max_; ++sweep) gap = correct(m, h, state, sweep);
  fly(m, h);
  fell_short_ = fell_short_ || gap > d_max_;
  return std::isfinite(gap) || break_at(m);
}

void Stepper::look_at_springs(double h, const world::WorldState& state) {
  if (plant_.springs.empty()) return;
  plant_.for_free([&](auto blocks) { plant_.bodies.look_ahead(blocks, h, plant_.model.gravity); });
  measure_springs_ahead(plant_, state, h);
}

// Newton's passes over the joints of what has rows, and over the rows. Gently, what the rows miss is left.
Stepper::Closed Stepper::close_with_rows(double h, const world::WorldState& state, bool gently) {
  double largest = 0.0, moved = 0.0;
  bool closed = false;
  for (int pass = 0; pass < most_passes_; ++pass) {
    largest = 0.0;
    closed = true;
    for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m) {
      if (!bounded_.binds(m)) continue;
      if (corrector_) corrector_->forget_look_ahead(m);
      const double gap = corrector_ ? correct(m, h, state, pass) : close(m, h, state, pass);
      closed = closed && gap <= d_max(m);
      if (gap <= largest || std::isnan(largest)) continue;
      largest = gap;
      break_at(m);
    }
    if (!std::isfinite(largest)) return Closed::kNo;
    look_at_springs(h, state);
    moved = gently && pass >= kGentlePasses ? 0.0 : std::abs(h) * bounded_.solve();
    if (!std::isfinite(moved)) return Closed::kNo;
    if (closed && (gently || moved <= d_max_)) return Closed::kYes;
  }
  const double most = divisible_ ? 0.0 : kApart;
  return corrector_ || (moved <= kApart && (closed || largest <= most)) ? Closed::kNearly : Closed::kNo;
}

// Mechanisms that share contacts, or have bounds of their own. Contacts that wedge joints may have no answer,
// or only with impulses that hold each other beyond all measure: then what comes near one is taken.
bool Stepper::close_together(double h, const world::WorldState& state) {
  broken_ = nullptr;
  Closed closed = close_with_rows(h, state, false);
  if (closed == Closed::kNo && broken_ != nullptr && has_laws_to_box(broken_mechanism_)) return false;
  if (closed == Closed::kNo && !corrector_) {
    for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m)
      if (bounded_.binds(m)) take_back(m, h);
    bounded_.start_gently(unpushed_v_, unpushed_w_);
    closed = close_with_rows(h, state, true);
    fell_short_ = true;
  }
  if (closed == Closed::kNo) return false;
  fell_short_ = fell_short_ || closed == Closed::kNearly;
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m) {
    if (!bounded_.binds(m)) continue;
    if (corrector_) corrector_->forget_look_ahead(m);
    fly(m, h);
  }
  return true;
}

bool Stepper::look_ahead(double h, const world::WorldState& state) {
  if (!corrector_) {
    copy(plant_.bodies.v, unpushed_v_);
    copy(plant_.bodies.w, unpushed_w_);
  }
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m)
    if (!plant_.mechanism_asleep[m] && !bounded_.binds(m) && !close_alone(m, h, state)) return false;
  if (!bounded_.empty() && !close_together(h, state)) return false;
  plant_.for_free([&](auto blocks) { plant_.bodies.look_ahead(blocks, h, plant_.model.gravity); });
  return true;
}

}  // namespace visum::dynamics::impulse
