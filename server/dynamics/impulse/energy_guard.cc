#include "server/dynamics/impulse/energy_guard.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/dynamics/impulse/bounded.h"

namespace visum::dynamics::impulse {
namespace {

// Share of an island's energies, and of its weight times a metre, that is rounding.
constexpr double kEnergyRounding = 1e-13;
constexpr double kPushedGain = 0.02;  // share of the kinetic energy, where contacts, stops or drives push
constexpr double kKept = 0.99;        // share of what was lost that still counts in the next step
constexpr double kMostLoss = 0.01;    // in a step that iterates: share of the kinetic energy

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
  jointed_.assign(bodies.size(), 0);
  for (const Touch& touch : plant.touches)
    if (!touch.asleep) join(touch.a, touch.b);
  for (const Spring& spring : plant.springs) join(spring.spec.a, spring.spec.b);
  for (const Mechanism& mechanism : plant.mechanisms)
    for (std::size_t node = 0; node < mechanism.size(); ++node) {
      join(mechanism.body(0), mechanism.body(node));
      jointed_[static_cast<std::size_t>(mechanism.body(node))] = 1;
    }
  kinetic_before_.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) kinetic_before_[i] = kinetic(bodies, i);
  pushed_.assign(bodies.size(), 0);
  const auto push = [&](int body) {
    if (body >= 0) pushed_[joined_.leader(static_cast<std::size_t>(body))] = 1;
  };
  for (const Touch& touch : plant.touches) push(std::max(touch.a, touch.b));
  for (const Spring& spring : plant.springs) push(spring.spec.b);
  for (const std::size_t i : plant.acting) push(plant.axes[i].b);
  rate_before_.clear();
  for (const std::size_t i : plant.acting) rate_before_.push_back(std::abs(plant.axes[i].rate));
}

// Upper bounds: an impulse times the fastest motion along it.
void EnergyGuard::count_given(const Plant& plant, std::span<const Wrench> wrenches, double h) {
  const Bodies& bodies = plant.bodies;
  for (std::size_t k = 0; k < plant.acting.size(); ++k) {
    const Axis& axis = plant.axes[plant.acting[k]];
    given_[joined_.leader(static_cast<std::size_t>(axis.b))] +=
        most_work_of_drive(plant, axis, rate_before_[k], h);
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

void EnergyGuard::measure(const Plant& plant, std::span<const Wrench> wrenches, double h) {
  const Bodies& bodies = plant.bodies;
  for (auto* list : {&gained_, &kinetic_after_, &given_, &size_, &weight_, &slowed_})
    list->assign(bodies.size(), 0.0);
  count_given(plant, wrenches, h);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double mass = bodies.constants[i].mass, now = kinetic(bodies, i);
    const std::size_t island = joined_.leader(i);
    bound_[island] = bound_[island] || bound_[i];
    jointed_[island] = jointed_[island] || jointed_[i];
    weight_[island] += mass * plant.model.gravity.norm();
    kinetic_after_[island] += now;
    gained_[island] += now - kinetic_before_[i] - mass * plant.model.gravity.dot(bodies.x[i] - before_.x[i]);
    size_[island] += now + kinetic_before_[i] + mass * plant.model.gravity.norm();
  }
}

std::vector<std::size_t> EnergyGuard::end(Plant& plant, std::span<const Wrench> wrenches, double h) {
  Bodies& bodies = plant.bodies;
  measure(plant, wrenches, h);
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

double EnergyGuard::excess(std::size_t island, double h, double allowed) const {
  if (!jointed_[island]) return 0.0;
  const double push = pushed_[island]
                          ? kPushedGain * kinetic_after_[island] + std::abs(h) * kMostPush * weight_[island]
                          : allowed * kinetic_after_[island];
  const double beyond = gained_[island] - given_[island] - push - lost_[island];
  return beyond <= kEnergyRounding * size_[island] ? 0.0 : beyond;
}

bool EnergyGuard::has_lost(std::size_t island) const {
  return jointed_[island] && !pushed_[island] && gained_[island] < -kMostLoss * kinetic_after_[island];
}

bool EnergyGuard::is_off(const Plant& plant, std::span<const Wrench> wrenches, double h, double allowed) {
  measure(plant, wrenches, h);
  for (std::size_t i = 0; i < plant.bodies.size(); ++i)
    if (joined_.leader(i) == i && (excess(i, h, allowed) != 0.0 || has_lost(i))) return true;
  return false;
}

// Where an island has gained more than its whole motion holds, it was lifted to close a gap. It then rests.
void EnergyGuard::take_back(Plant& plant, std::span<const Wrench> wrenches, double h, double allowed) {
  measure(plant, wrenches, h);
  Bodies& bodies = plant.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::size_t island = joined_.leader(i);
    const double gain = excess(island, h, allowed);
    if (gain == 0.0) continue;
    if (i == island) slowed_[island] = std::min(gain, kinetic_after_[island]);
    const double share = std::sqrt(std::max(0.0, 1.0 - gain / kinetic_after_[island]));
    bodies.v[i] *= share;
    bodies.w[i] *= share;
  }
}

// A loss counts for about a hundred steps.
void EnergyGuard::settle() {
  for (std::size_t i = 0; i < lost_.size(); ++i) {
    const bool keeps = joined_.leader(i) == i && jointed_[i] && !pushed_[i];
    lost_[i] = keeps ? std::max(0.0, kKept * lost_[i] - (gained_[i] - slowed_[i])) : 0.0;
  }
}

void EnergyGuard::read(std::span<const std::byte> from) {
  std::ranges::fill(lost_, 0.0);
  if (!lost_.empty() && from.size() == bytes()) std::memcpy(lost_.data(), from.data(), from.size());
}

void EnergyGuard::write(std::span<std::byte> to) const {
  if (!lost_.empty()) std::memcpy(to.data(), lost_.data(), bytes());
}

}  // namespace visum::dynamics::impulse
