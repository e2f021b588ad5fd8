// `solver: iterate` keeps linked bodies together, however few corrections they get. The iteration
// may stop anywhere, and then leaves gaps; closing a gap later kicks the bodies and may add energy. So a step
// that leaves a large gap or gains energy is made again, firmly: all joints at once, as the solver `direct`
// makes it. What a firm step gains, too, is taken back by slowing the bodies down (energy_guard.h).
#include <algorithm>
#include <cmath>
#include <utility>

#include "server/dynamics/impulse/stepper.h"

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostMoves = 8;       // passes that bring joints together
constexpr double kMostLeft = 0.02;  // m, rad: a larger gap is not left to the next step
// A step is smooth if it starts from smaller gaps (m, rad), leaves smaller ones, and turns no body farther
// (rad). Its error of energy goes up and down, and does not add up.
constexpr double kSmallGap = 1e-4, kSmallTurn = 0.05;
constexpr double kSmoothGain = 1e-4;  // share of the kinetic energy that a smooth step may gain

}  // namespace

void Stepper::set_firm(bool firm) {
  if (!corrector_ || firm == firm_) return;
  firm_ = firm;
  plan_.iterates = !firm;
  std::swap(plan_.bounds, firm_bounds_);
}

bool Stepper::take_firmly() {
  if (!plan_.iterates) return false;
  set_firm(true);
  return true;
}

// A flight from rest without gravity, in which nothing acts but joints, moves the bodies by as little as
// closes the gaps (each body by its mass). They keep their velocities, so closing a gap kicks nothing.
void Stepper::move_together() {
  Bodies& bodies = plant_.bodies;
  const Vector3d nowhere = Vector3d::Zero();
  for (const Axis& axis : plant_.acting_axes())
    if (axis.node >= 0) plant_.mechanisms[axis.mechanism].set_axis(static_cast<std::size_t>(axis.node), {});
  copy(bodies.v, scratch_.unpushed_v);
  copy(bodies.w, scratch_.unpushed_w);
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m) {
    Mechanism& mechanism = plant_.mechanisms[m];
    if (plant_.mechanism_asleep[m]) continue;
    mechanism.place(bodies, *plan_.state);
    for (std::size_t i = 0; i < mechanism.size(); ++i) {
      const auto body = static_cast<std::size_t>(mechanism.body(i));
      bodies.v[body] = bodies.w[body] = Vector3d::Zero();
    }
    double before = 0.0, gap = 0.0;
    for (int pass = 0; pass < kMostMoves; ++pass) {
      plant_.work.take(mechanism.units());
      bodies.look_ahead(mechanism.blocks(), plan_.h, nowhere);
      mechanism.clear();
      gap = mechanism.ask_gaps(bodies, *plan_.state, plan_.h);
      if (pass == 0) before = gap;
      if (!(gap > plan_.bounds.d_max_by_mechanism[m])) break;
      if (pass == 0) mechanism.factor(bodies);
      mechanism.solve();
      mechanism.apply(bodies);
    }
    if (gap < before && bodies.commit(mechanism.blocks(), plan_.h, nowhere)) mechanism.forget_place();
    for (std::size_t i = 0; i < mechanism.size(); ++i) {
      const auto body = static_cast<std::size_t>(mechanism.body(i));
      bodies.v[body] = scratch_.unpushed_v[body];
      bodies.w[body] = scratch_.unpushed_w[body];
    }
  }
}

double Stepper::fastest_turn() const {
  double fastest = 0.0;
  for (const Mechanism& mechanism : plant_.mechanisms)
    fastest = std::max(fastest, mechanism.largest_turn(plant_.bodies));
  return fastest;
}

// Where each joint was within its bound, nothing is left.
bool Stepper::holds_together() {
  began_apart_ = left_apart_ = 0.0;
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m) {
    if (plant_.mechanism_asleep[m]) continue;
    began_apart_ = std::max(began_apart_, corrector_->largest_gap(m));
    if (!fell_short_) continue;
    plant_.mechanisms[m].clear();
    left_apart_ = std::max(left_apart_, plant_.mechanisms[m].ask_gaps(plant_.bodies, *plan_.state, plan_.h));
    if (!(left_apart_ <= kMostLeft)) return false;
  }
  return true;
}

bool Stepper::keep_energy() {
  const bool apart = plan_.iterates && std::max(began_apart_, left_apart_) > kSmallGap;
  const bool smooth = !apart && std::abs(plan_.h) * fastest_turn() <= kSmallTurn;
  const double allowed = smooth ? kSmoothGain : 0.0;
  if (apart) {
    if (guard_.is_off(plant_, plan_.wrenches, plan_.h, allowed)) return false;
  } else {
    guard_.take_back(plant_, plan_.wrenches, plan_.h, allowed);
  }
  guard_.settle();
  return true;
}

}  // namespace visum::dynamics::impulse
