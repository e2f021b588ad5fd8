// An island's step in a tick whose work has met its limit (work_budget.h). Its own work grows with the
// numbers of bodies, joints and contacts only, whatever they do to each other.
//
// Joints are closed as always. What pushes (contacts, stops, laws at their limit) sees every body as if it
// had no joints, starts from the best impulses that were reached, and takes turns with the joints a few
// times. Sweeps of projected Gauss-Seidel never give what a bound forbids, and may stop anywhere. Hits do not
// bounce, and nothing is driven out of an overlap. What then has gained energy is slowed down; bodies whose
// joints do not close stay where they were, at rest (energy_guard.h).
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/island_stepper.h"

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostTurns = 6;        // of joints and rows, at t and again at t+h
constexpr int kMostRepetitions = 3;  // because laws reach their limit; in the last one all laws are rows
constexpr double kShort = 1e-6;      // m/s, rad/s: a row that misses more has fallen short

}  // namespace

// Laws take part as they suit; the last repetition makes rows of all of them, whose bounds always hold.
void IslandStepper::box_laws() {
  plant_.for_axes(island_, [](Axis& axis) {
    axis.boxed = axis.boxed || axis.acts;
    axis.at_limit = 0;
  });
}

void IslandStepper::foresee_limited(std::size_t island, IslandFate& fate) {
  begin(island, fate);
  bounded_.take_apart(true);
  save_velocities();
  for (const std::size_t m : mechanisms()) plant_.mechanisms[m].prediction().forget();
  for (int i = 0; i < kMostRepetitions; ++i) {
    if (i + 1 == kMostRepetitions) box_laws();
    begin_ahead(i > 0);
    fate_->held = false;
    plant_.for_touches(island_, [](Touch& touch) { touch.bounce = 0.0; });
    bounded_.build(island_, kAhead, plan_.h, fate_->course);
    look_ahead_limited();
    bounded_.report();
    if (!change_laws(plant_, island_, kAhead, plan_.h, true)) break;
  }
  bounded_.take_apart(false);
}

void IslandStepper::look_ahead_limited() {
  for (int turn = 0; turn < kMostTurns; ++turn) {
    each_awake([&](std::size_t m) {
      if (!bounded_.binds(m)) return;
      if (plan_.iterates) corrector().forget_look_ahead(m);
      plan_.iterates ? correct(m, turn) : close(m, turn);
    });
    look_at_springs();
    if (bounded_.has_rows()) bounded_.solve();
  }
  // The joints have the last word.
  each_awake([&](std::size_t m) {
    const bool closes = plan_.iterates ? correct_alone(m) : close_by_newton(m, bounded_.binds(m));
    fate_->held = fate_->held || !closes;
  });
}

void IslandStepper::correct_limited(std::size_t island, IslandFate& fate, std::vector<std::size_t>& found) {
  begin(island, fate);
  bounded_.take_apart(true);
  commit();
  begin_after();
  find_velocities_limited();
  bounded_.find_short(kShort, found);
  bounded_.take_apart(false);
}

void IslandStepper::find_velocities_limited() {
  for (int i = 0; i < kMostRepetitions; ++i) {
    if (i > 0) restore_velocities();
    if (i + 1 == kMostRepetitions) box_laws();
    push();
    factor(kAfter);
    bounded_.build(island_, kAfter, plan_.h, fate_->course);
    for (int turn = 0; turn < kMostTurns; ++turn) {
      each_awake([&](std::size_t m) {
        if (turn == 0 || bounded_.binds(m)) match_velocities(m, turn == 0);
      });
      if (bounded_.has_rows() && turn + 1 < kMostTurns) bounded_.solve();
    }
    bounded_.report();
    if (!change_laws(plant_, island_, kAfter, plan_.h, true) || i + 1 == kMostRepetitions) return;
    plant_.for_axes(island_, [](Axis& axis) { axis.law[kAfter] = axis.damped[kAfter] = 0.0; });
  }
}

}  // namespace visum::dynamics::impulse
