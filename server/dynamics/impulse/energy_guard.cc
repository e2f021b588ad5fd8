#include "server/dynamics/impulse/energy_guard.h"

#include <algorithm>
#include <cmath>

namespace visum::dynamics::impulse {
namespace {

// Share of an island's energies, and of its weight times a metre, that is rounding.
constexpr double kEnergyRounding = 1e-13;

}  // namespace

// A body that meets something that does not move is bound, too.
void EnergyGuard::join(int a, int b) {
  for (const int body : {a, b})
    if (body >= 0) bound_[static_cast<std::size_t>(body)] = 1;
  if (a < 0 || b < 0) return;
  joined_.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
}

double EnergyGuard::kinetic(const Bodies& bodies, std::size_t i) const {
  return 0.5 * (bodies.constants[i].mass * bodies.v[i].squaredNorm() +
                bodies.w[i].dot(bodies.inertia[i] * bodies.w[i]));
}

void EnergyGuard::begin(const Plant& plant) {
  const Bodies& bodies = plant.bodies;
  bodies.keep(before_);
  joined_.separate(bodies.size());
  bound_.assign(bodies.size(), 0);
  held_.assign(bodies.size(), 0);
  for (const Touch& touch : plant.touches)
    if (!touch.asleep) join(touch.a, touch.b);
  for (const Spring& spring : plant.springs) join(spring.spec.a, spring.spec.b);
  for (const Mechanism& mechanism : plant.mechanisms)
    for (std::size_t node = 0; node < mechanism.size(); ++node) join(mechanism.body(0), mechanism.body(node));
  kinetic_before_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) kinetic_before_[i] = kinetic(bodies, i);
  rate_before_.clear();
  for (const std::size_t i : plant.acting) rate_before_.push_back(std::abs(plant.axes[i].rate));
}

// Upper bounds: an impulse times the fastest motion along it. A law that asks for rest gives nothing.
void EnergyGuard::count_given(const Plant& plant, std::span<const Wrench> wrenches, double h) {
  const Bodies& bodies = plant.bodies;
  for (std::size_t k = 0; k < plant.acting.size(); ++k) {
    const Axis& axis = plant.axes[plant.acting[k]];
    const double law = axis.target == 0.0 ? 0.0 : std::abs(axis.law[kAhead]) + std::abs(axis.law[kAfter]);
    const double fastest = std::max({rate_before_[k], std::abs(axis.mean_rate), std::abs(plant.rate(axis))});
    given_[joined_.leader(static_cast<std::size_t>(axis.b))] +=
        (law + h * std::abs(axis.feedforward)) * fastest;
  }
  for (const Wrench& wrench : wrenches) {
    if (bodies.number(wrench.body) < 0) continue;
    const auto i = static_cast<std::size_t>(bodies.number(wrench.body));
    given_[joined_.leader(i)] +=
        h * (wrench.force_n.norm() * std::max(before_.v[i].norm(), bodies.v[i].norm()) +
             wrench.torque_nm.norm() * std::max(before_.w[i].norm(), bodies.w[i].norm()));
  }
  for (const Spring& spring : plant.springs)
    given_[joined_.leader(static_cast<std::size_t>(spring.spec.b))] +=
        2.0 * std::abs(spring.impulse * spring.mean_rate);
  for (const Touch& touch : plant.touches) {
    if (touch.asleep || touch.foreign.isZero(0.0)) continue;
    const double impulse = touch.impulse[kAhead].norm() + touch.impulse[kAfter].norm();
    given_[joined_.leader(static_cast<std::size_t>(std::max(touch.a, touch.b)))] +=
        impulse * touch.foreign.norm();
  }
}

std::vector<std::size_t> EnergyGuard::end(Plant& plant, std::span<const Wrench> wrenches, double h) {
  Bodies& bodies = plant.bodies;
  for (auto* list : {&gained_, &kinetic_after_, &given_, &size_}) list->assign(bodies.size(), 0.0);
  count_given(plant, wrenches, h);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double mass = bodies.constants[i].mass, now = kinetic(bodies, i);
    const std::size_t island = joined_.leader(i);
    bound_[island] = bound_[island] || bound_[i];
    kinetic_after_[island] += now;
    gained_[island] += now - kinetic_before_[i] - mass * plant.model.gravity.dot(bodies.x[i] - before_.x[i]);
    size_[island] += now + kinetic_before_[i] + mass * plant.model.gravity.norm();
  }
  // The share of its velocity that each island keeps; kinetic energy goes with its square.
  std::vector<std::size_t> stay;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::size_t island = joined_.leader(i);
    if (!bound_[island] && std::isfinite(gained_[island])) continue;
    const double excess = gained_[island] - given_[island];
    if (!held_[island] && excess <= kEnergyRounding * size_[island]) continue;
    if (!held_[island] && excess < kinetic_after_[island]) {
      const double share = std::sqrt(1.0 - excess / kinetic_after_[island]);
      bodies.v[i] *= share;
      bodies.w[i] *= share;
      continue;
    }
    stay.push_back(i);
  }
  bodies.put_to_rest(before_, stay);
  return stay;
}

}  // namespace visum::dynamics::impulse
