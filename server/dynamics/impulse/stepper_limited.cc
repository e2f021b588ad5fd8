// The step of a tick whose work has met its limit (work_budget.h). Its own work grows with the numbers of
// bodies, joints and contacts only, whatever they do to each other.
//
// Joints are closed as always. What pushes (contacts, stops, laws at their limit) sees every body as if it
// had no joints, starts from the best impulses that were reached, and takes turns with the joints a few
// times. Sweeps of projected Gauss-Seidel never give what a bound forbids, and may stop anywhere. Hits do not
// bounce, and nothing is driven out of an overlap. What then has gained energy is slowed down; bodies whose
// joints do not close stay where they were, at rest (energy_guard.h).
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/stepper.h"

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostTurns = 6;        // of joints and rows, at t and again at t+h
constexpr int kMostRepetitions = 3;  // because laws reach their limit; in the last one all laws are rows
constexpr double kShort = 1e-6;      // m/s, rad/s: a row that misses more has fallen short

}  // namespace

bool Stepper::step_limited(double h, std::span<const Wrench> wrenches, const world::WorldState& state) {
  divisible_ = false;
  fell_short_ = true;
  short_bodies_.clear();
  bounded_.take_apart(true);
  guard_.begin(plant_);
  save_velocities();
  for (Mechanism& mechanism : plant_.mechanisms) mechanism.prediction().forget();
  foresee_limited(h, wrenches, state);
  commit(h);
  correct_velocities_limited(h, wrenches, state);
  // Bodies that stay have felt nothing.
  const std::vector<std::size_t> stay = guard_.end(plant_, wrenches, h);
  const auto stays = [&](int body) {
    return body >= 0 && std::ranges::binary_search(stay, static_cast<std::size_t>(body));
  };
  for (Touch& touch : plant_.touches)
    if (!touch.asleep && (stays(touch.a) || stays(touch.b)))
      for (std::size_t k = 0; k < kMoments; ++k) touch.impulse[k] = touch.twist[k] = Vector3d::Zero();
  short_bodies_.insert(short_bodies_.end(), stay.begin(), stay.end());
  bounded_.find_short(kShort, short_bodies_);
  count_impulses();
  bounded_.take_apart(false);
  return stay.empty();
}

// Laws take part as they suit; the last repetition makes rows of all of them, whose bounds always hold.
void Stepper::box_laws() {
  for (Axis& axis : plant_.acting_axes()) {
    axis.boxed = axis.boxed || axis.acts;
    axis.at_limit = 0;
  }
}

void Stepper::foresee_limited(double h, std::span<const Wrench> wrenches, const world::WorldState& state) {
  for (int i = 0; i < kMostRepetitions; ++i) {
    if (i > 0) restore_velocities();
    if (i + 1 == kMostRepetitions) box_laws();
    reset_impulses(plant_);
    guard_.release();
    for (Touch& touch : plant_.touches) touch.bounce = 0.0;
    for (Mechanism& mechanism : plant_.mechanisms) mechanism.begin_step(h);
    push(h, wrenches);
    factor(h, state);
    measure_springs(plant_, state);
    bounded_.build(kAhead, h);
    look_ahead_limited(h, state);
    bounded_.report();
    if (!change_laws(plant_, kAhead, h, true)) return;
  }
}

void Stepper::look_ahead_limited(double h, const world::WorldState& state) {
  const auto each_awake = [&](auto act) {
    for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m)
      if (!plant_.mechanism_asleep[m]) act(m);
  };
  for (int turn = 0; turn < kMostTurns; ++turn) {
    each_awake([&](std::size_t m) {
      if (!bounded_.binds(m)) return;
      if (iterates_) corrector_->forget_look_ahead(m);
      iterates_ ? correct(m, h, state, turn) : close(m, h, state, turn);
    });
    for (std::size_t i = 0; i < plant_.islands.size(); ++i) look_at_springs(i, h, state);
    solve_each_island();
  }
  // The joints have the last word.
  each_awake([&](std::size_t m) {
    const bool bound = bounded_.binds(m);
    const bool closes = iterates_ ? correct_alone(m, h, state) : close_by_newton(m, h, state, bound);
    if (!closes) guard_.hold(static_cast<std::size_t>(plant_.mechanisms[m].body(0)));
  });
  plant_.for_free([&](auto blocks) { plant_.bodies.look_ahead(blocks, h, plant_.model.gravity); });
}

void Stepper::correct_velocities_limited(double h, std::span<const Wrench> wrenches,
                                         const world::WorldState& state) {
  begin_after(state);
  for (int i = 0; i < kMostRepetitions; ++i) {
    if (i > 0) restore_velocities();
    if (i + 1 == kMostRepetitions) box_laws();
    push(h, wrenches);
    factor(h, state);
    bounded_.build(kAfter, h);
    for (int turn = 0; turn < kMostTurns; ++turn) {
      for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m)
        if (!plant_.mechanism_asleep[m] && (turn == 0 || bounded_.binds(m)))
          match_velocities(m, h, turn == 0);
      if (turn + 1 < kMostTurns) solve_each_island();
    }
    if (!bounded_.has_rows()) return;
    bounded_.report();
    if (!change_laws(plant_, kAfter, h, true) || i + 1 == kMostRepetitions) return;
    for (Axis& axis : plant_.acting_axes()) axis.law[kAfter] = axis.damped[kAfter] = 0.0;
  }
}

}  // namespace visum::dynamics::impulse
