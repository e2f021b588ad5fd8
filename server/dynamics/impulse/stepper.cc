#include "server/dynamics/impulse/stepper.h"

#include <numbers>

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostPasses = 40;   // passes of Newton; each closes the joints to second order
constexpr int kMostChanges = 12;  // repetitions because laws reached or left their limit
constexpr int kTautCutsLeft =
    3;  // with fewer cuts left, tension asks for no more: where contacts wedge joints it has no end
constexpr double kMostGain = 0.02;  // share of the kinetic energy: rounding gains less than this
constexpr double kFirmDMax = 1e-6;  // m, rad: largest gap that a firm step leaves
constexpr int kFreeChanges = 2;     // repetitions before a law that still changes becomes a row

// The default gap of each solver and order, m and rad. For `direct` it fits the error of a step at 1 ms, for
// `iterate` it is what the iteration reaches. Around a loop small gaps add up.
double default_d_max(const world::EngineSetting& setting, bool in_loops) {
  if (setting.solver == "iterate") return 1e-6;
  if (setting.order == 2) return in_loops ? 8e-11 : 1e-7;
  if (in_loops) return 2e-11;
  return setting.order == 4 ? 1e-10 : 1e-13;
}

// The setting holds for the whole gap; this is its share along each axis of W.
double find_d_max(const world::EngineSetting& setting, bool in_loops) {
  const double whole = setting.d_max > 0.0 ? setting.d_max : default_d_max(setting, in_loops);
  return whole / std::numbers::sqrt3;
}

// Mechanisms with loops have a smaller gap. A spring between two bodies of one mechanism closes a loop, too.
std::vector<double> find_d_max_by_mechanism(const Plant& plant, const world::EngineSetting& setting) {
  std::vector<double> found(plant.mechanisms.size(), find_d_max(setting, false));
  const double in_loops = find_d_max(setting, true);
  for (std::size_t m = 0; m < found.size(); ++m)
    if (plant.mechanisms[m].loop_count() > 0) found[m] = in_loops;
  const auto mechanism_of = [&](int body) {
    return body < 0 ? -1 : plant.places[static_cast<std::size_t>(body)].mechanism;
  };
  for (const Spring& spring : plant.springs) {
    const int m = mechanism_of(spring.spec.b);
    if (m >= 0 && m == mechanism_of(spring.spec.a)) found[static_cast<std::size_t>(m)] = in_loops;
  }
  return found;
}

Stepper::Bounds bounds_of(const Plant& plant, const world::EngineSetting& setting) {
  return {find_d_max(setting, false), find_d_max_by_mechanism(plant, setting), kMostPasses};
}

// Adds a contact's impulses to the tick's totals. A sleeping contact repeats what it gave at t+h, half of a
// tick's.
void count(Touch& touch) {
  if (touch.asleep) {
    touch.total_normal = 2.0 * touch.impulse[kAhead][0];
    touch.total = 2.0 * touch.kept_impulse;
    touch.total_twist = 2.0 * touch.kept_twist;
    return;
  }
  const Vector3d impulse = touch.impulse[kHit] + touch.impulse[kAhead] + touch.impulse[kAfter];
  touch.total_normal += impulse[0];
  touch.total += touch.frame * impulse;
  if (is_held_from_turning(touch))
    touch.total_twist += touch.frame * (touch.twist[kHit] + touch.twist[kAhead] + touch.twist[kAfter]);
}

}  // namespace

Stepper::Stepper(Plant& plant)
    : plant_(plant),
      bounded_(plant),
      bounds_(bounds_of(plant, plant.setting)),
      saved_rates_(plant.axes.size()),
      saved_v_(plant.bodies.size()),
      saved_w_(plant.bodies.size()) {
  bound_bodies_.reserve(plant.bodies.size());
  watched_.reserve(plant.mechanisms.size());
  if (plant.setting.solver != "iterate") return;
  corrector_.emplace(plant);
  iterates_ = true;
  guard_.start(plant.bodies.size());
  bounds_.most_passes = plant.setting.budget;
  // A firm step is one of the solver `direct`, with its bounds where the setting's are wider.
  world::EngineSetting firm = plant.setting;
  firm.solver = "direct";
  if (firm.d_max > kFirmDMax) firm.d_max = kFirmDMax;
  firm_bounds_ = bounds_of(plant, firm);
  for (Mechanism& mechanism : plant.mechanisms) mechanism.start_noting(plant.bodies);
}

// A pure torque for an angle; for a distance a force at the joint's point, with its torque about each centre
// of mass.
void Stepper::push_axis(const Axis& axis, double impulse) {
  Bodies& bodies = plant_.bodies;
  const JointPose pose = pose_now(*axis.spec, bodies, axis.start);
  const bool turns = axis.turns;
  const auto push = [&](int number, double sign) {
    if (number < 0) return;
    const auto i = static_cast<std::size_t>(number);
    if (!turns) bodies.v[i] += sign * impulse * bodies.constants[i].inverse_mass * pose.a;
    const Vector3d twist = turns ? pose.a : (pose.pb - bodies.x[i]).cross(pose.a);
    bodies.w[i] += sign * impulse * (bodies.inverse_inertia[i] * twist);
  };
  push(axis.a, -1.0);
  push(axis.b, 1.0);
}

// At each end of a step the bodies get half of the forces' impulse. The feedforward of a drive is different:
// given to its two bodies alone, it would throw them far off the joint. Where joints are solved together,
// push_known() hands it to all bodies of the tree at once.
void Stepper::push(double h, std::span<const Wrench> wrenches) {
  Bodies& bodies = plant_.bodies;
  for (const Wrench& wrench : wrenches) {
    const int number = bodies.number(wrench.body);
    if (number < 0) continue;
    const auto i = static_cast<std::size_t>(number);
    bodies.v[i] += 0.5 * h * bodies.constants[i].inverse_mass * wrench.force_n;
    bodies.w[i] += 0.5 * h * (bodies.inverse_inertia[i] * wrench.torque_nm);
  }
  for (const Axis& axis : plant_.acting_axes())
    if (axis.feedforward != 0.0 && (iterates_ || axis.node < 0)) push_axis(axis, 0.5 * h * axis.feedforward);
}

// The tree's axes only: axes that close loops are pushed by push().
bool Stepper::push_known(std::size_t m, Moment moment, double h) {
  bool any = false;
  for (const Axis& axis : plant_.acting_axes_of(m)) {
    if (axis.node < 0) continue;
    const double impulse = known_impulse(axis, moment, h);
    if (impulse == 0.0) continue;
    plant_.mechanisms[m].tree().push_axis(static_cast<std::size_t>(axis.node), impulse);
    any = true;
  }
  return any;
}

// A moment is solved again only where a law changes how it takes part; without acting axes nothing need be
// saved.
void Stepper::save_velocities() {
  if (plant_.acting.empty()) return;
  for (const std::size_t i : plant_.acting) saved_rates_[i] = plant_.axes[i].rate;
  copy(plant_.bodies.v, saved_v_);
  copy(plant_.bodies.w, saved_w_);
}

void Stepper::restore_velocities() {
  for (const std::size_t i : plant_.acting) plant_.axes[i].rate = saved_rates_[i];
  plant_.bodies.v = saved_v_;
  plant_.bodies.w = saved_w_;
}

void Stepper::factor(double h, const world::WorldState& state) {
  // The laws must be in the tree before it is factored.
  set_tree_axes(plant_, h);
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m) {
    if (plant_.mechanism_asleep[m]) continue;
    plant_.work.take(plant_.mechanisms[m].factor_units());
    const bool changed = plant_.mechanisms[m].place(plant_.bodies, state);
    if (!iterates_)
      plant_.mechanisms[m].factor(plant_.bodies);
    else if (changed || prepared_h_ != h)
      corrector_->prepare(m, h);
  }
  prepared_h_ = iterates_ ? h : 0.0;
}

const JointSpec* Stepper::worst_joint(std::size_t m) const {
  return iterates_ ? corrector_->worst_joint() : plant_.mechanisms[m].worst_joint();
}

bool Stepper::is_too_taut(double h) const {
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m) {
    const Mechanism& mechanism = plant_.mechanisms[m];
    if (mechanism.notes() && !plant_.mechanism_asleep[m] && mechanism.is_too_taut(h)) return true;
  }
  return false;
}

bool Stepper::step(double h, std::span<const Wrench> wrenches, const world::WorldState& state,
                   int cuts_left) {
  plant_.work.take(WorkBudget::kPerBody * plant_.bodies.size());
  divisible_ = cuts_left > 0;
  if (corrector_) guard_.begin(plant_);
  if (firm_) move_together(h, state);
  // Impulses at t, then the bodies move, then velocities at t+h. Everything after commit() concerns t+h.
  save_velocities();
  fell_short_ = firm_;
  if (!foresee(h, wrenches, state)) return false;
  if (!iterates_ && cuts_left > kTautCutsLeft && is_too_taut(h)) return false;
  if (iterates_ && !holds_together(h, state)) return false;
  commit(h);
  correct_velocities(h, wrenches, state);
  give_back_energy(h);
  if (corrector_ && !keep_energy(h, wrenches)) return false;
  count_impulses();
  note_joints();
  carry_touches(plant_, h);
  return true;
}

// A law in the tree may ask for the impossible in two cases. A loop may move the axis on, as a crank moves a
// piston with friction through its dead centre. Or the laws hold so many axes that nothing free is left to
// close the loop. As a row the law knows its limit.
bool Stepper::has_laws_to_box(std::size_t m) const {
  bool any = false;
  if (plant_.mechanisms[m].loop_count() > 0)
    for (const Axis& axis : plant_.acting_axes_of(m)) any = any || law_in_tree(axis);
  return any;
}

bool Stepper::take_laws_as_rows(std::size_t m) {
  if (!has_laws_to_box(m)) return false;
  for (Axis& axis : plant_.acting_axes_of(m)) axis.boxed = axis.boxed || law_in_tree(axis);
  return true;
}

// Impulses at t. Each repetition starts from the saved velocities.
bool Stepper::foresee(double h, std::span<const Wrench> wrenches, const world::WorldState& state) {
  for (int i = 0; i < kMostChanges; ++i) {
    // Everything is undone that an earlier try has given.
    if (i > 0) restore_velocities();
    reset_impulses(plant_);
    for (Mechanism& mechanism : plant_.mechanisms) mechanism.begin_step(h);
    // Forces, and the factors at t.
    push(h, wrenches);
    factor(h, state);
    measure_springs(plant_, state);
    // Collisions change velocities at once; laws that they push over their limit change first.
    if (find_hits(plant_, h)) {
      hit(h);
      if (i + 1 < kMostChanges && change_laws(plant_, kHit, h, true)) continue;
    }
    // The look-ahead, with rows that may bind. A law of a loop that cannot hold its axis becomes a row.
    bounded_.build(kAhead, h);
    note_energy(wrenches);
    if (!look_ahead(h, state)) {
      if (i + 1 < kMostChanges && broken_ != nullptr && take_laws_as_rows(broken_mechanism_)) continue;
      return false;
    }
    bounded_.report();
    // Solved, unless a law now takes part in another way. The iterative solver and late repetitions use rows.
    if (!change_laws(plant_, kAhead, h, corrector_ || i >= kFreeChanges)) return true;
  }
  fell_short_ = true;
  return true;
}

void Stepper::hit(double h) {
  bounded_.build(kHit, h);
  for (std::size_t island = 0; island < plant_.islands.size(); ++island)
    if (bounded_.has_rows(island)) bounded_.bounce(island);
  bounded_.report();
  for (Axis& axis : plant_.acting_axes()) axis.rate = plant_.rate(axis);
}

// True if anything but gravity may do work in the island: drives, springs, wrenches, bodies of other engines.
bool Stepper::is_worked_on(std::size_t island, std::span<const Wrench> wrenches) const {
  const Islands& islands = plant_.islands;
  // Wrenches are few, and looking for their bodies' islands is not worth it.
  return !wrenches.empty() || !islands.springs(island).empty() ||
         std::ranges::any_of(
             islands.mechanisms(island),
             [&](std::size_t m) { return plant_.first_acting[m] < plant_.first_acting[m + 1]; }) ||
         std::ranges::any_of(islands.touches(island),
                             [&](std::size_t i) { return !plant_.touches[i].foreign.isZero(0.0); });
}

// The mechanisms with rows count, and the free bodies that touch them.
void Stepper::note_energy(std::span<const Wrench> wrenches) {
  bound_bodies_.clear();
  watched_.clear();
  for (std::size_t island = 0; island < plant_.islands.size(); ++island) {
    const std::size_t first = bound_bodies_.size();
    if (!bounded_.has_rows(island) || is_worked_on(island, wrenches)) continue;
    for (const std::size_t m : plant_.islands.mechanisms(island))
      for (std::size_t node = 0; bounded_.binds(m) && node < plant_.mechanisms[m].size(); ++node)
        bound_bodies_.push_back(static_cast<std::size_t>(plant_.mechanisms[m].body(node)));
    if (bound_bodies_.size() == first) continue;
    for (const std::size_t i : bounded_.free_bodies(island)) bound_bodies_.push_back(i);
    const Watched watched{first, bound_bodies_.size() - first, 0.0};
    const Energy energy = energy_of(watched);
    watched_.push_back({watched.first, watched.count, energy.kinetic + energy.potential});
  }
}

Stepper::Energy Stepper::energy_of(const Watched& watched) const {
  const Bodies& bodies = plant_.bodies;
  Energy energy;
  for (const std::size_t i : std::span(bound_bodies_).subspan(watched.first, watched.count)) {
    const double mass = bodies.constants[i].mass;
    energy.kinetic +=
        0.5 * (mass * bodies.v[i].squaredNorm() + bodies.w[i].dot(bodies.inertia[i] * bodies.w[i]));
    energy.potential -= mass * plant_.model.gravity.dot(bodies.x[i]);
    energy.weight += mass * plant_.model.gravity.norm();
  }
  return energy;
}

// A solution that only comes near an answer may have gained energy: more than rounding, and more than lifting
// overlapping bodies apart takes. Then all motion of that island is slowed down alike, which joints allow.
void Stepper::give_back_energy(double h) {
  for (const Watched& watched : watched_) {
    const Energy now = energy_of(watched);
    const double gained = now.kinetic + now.potential - watched.energy_before;
    if (!(gained > kMostGain * now.kinetic + std::abs(h) * kMostPush * now.weight)) continue;
    // Takes the gain out of the kinetic energy.
    const double share = std::sqrt(std::max(0.0, 1.0 - gained / now.kinetic));
    for (const std::size_t i : std::span(bound_bodies_).subspan(watched.first, watched.count)) {
      plant_.bodies.v[i] *= share;
      plant_.bodies.w[i] *= share;
    }
    fell_short_ = true;
  }
}

// A mechanism that has moved needs new poses and factors.
void Stepper::commit(double h) {
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m)
    if (!plant_.mechanism_asleep[m] &&
        plant_.bodies.commit(plant_.mechanisms[m].blocks(), h, plant_.model.gravity))
      plant_.mechanisms[m].forget_place();
  plant_.for_free([&](auto blocks) { plant_.bodies.commit(blocks, h, plant_.model.gravity); });
}

void Stepper::match_velocities(std::size_t m, double h, bool first) {
  // The iterative solver sweeps until v_max, or until its budget is spent.
  if (iterates_) {
    const double v_max = plant_.setting.v_max;
    for (int sweep = 0; sweep < bounds_.most_passes; ++sweep) {
      plant_.work.take(plant_.mechanisms[m].units());
      if (corrector_->sweep_velocities(m, h, v_max, sweep) <= v_max) return;
    }
    fell_short_ = true;
    return;
  }
  // The direct solver asks for velocities that agree along all joints at once.
  Mechanism& mechanism = plant_.mechanisms[m];
  plant_.work.take(mechanism.units());
  mechanism.clear();
  mechanism.ask_velocities(plant_.bodies);
  ask_axes(plant_, m, kAfter, h);
  if (first) push_known(m, kAfter, h);
  give_answer(m, kAfter);
}

// The rows at t+h start from what they gave at t, and what was added to that in the last step. The springs
// repeat their impulse; contacts meet at one point again.
void Stepper::begin_after(const world::WorldState& state) {
  push_by_springs(plant_, state);
  save_velocities();
  meet_touches(plant_);
  for (Touch& touch : plant_.touches) {
    touch.impulse[kAfter] = touch.impulse[kAhead] + touch.frame.transpose() * touch.kept_change;
    touch.impulse[kAfter][0] = std::max(touch.impulse[kAfter][0], -touch.impulse[kAhead][0]);
    touch.twist[kAfter] = touch.twist[kAhead];
  }
}

void Stepper::solve_each_island() {
  for_islands([this](std::size_t worker, std::size_t i) {
    bounded_.solve(i, worker);
    return true;
  });
}

void Stepper::correct_velocities(double h, std::span<const Wrench> wrenches, const world::WorldState& state) {
  begin_after(state);
  for (int i = 0; i < kMostChanges; ++i) {
    if (i > 0) restore_velocities();
    push(h, wrenches);
    factor(h, state);
    for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m)
      if (!plant_.mechanism_asleep[m]) match_velocities(m, h);
    bounded_.build(kAfter, h);
    solve_each_island();
    bounded_.report();
    if (!change_laws(plant_, kAfter, h, corrector_ || i >= kFreeChanges)) return;
    if (i + 1 == kMostChanges) break;
    // The laws' impulses at t+h are found anew.
    for (Axis& axis : plant_.acting_axes()) axis.law[kAfter] = axis.damped[kAfter] = 0.0;
    for (Mechanism& mechanism : plant_.mechanisms) mechanism.prediction().take_back_after();
  }
  fell_short_ = true;
}

// Rows may push something else in the next step, so nothing is foreseen for the joints of a mechanism that
// has them. Nor is it where loops lose their grip.
void Stepper::note_joints() {
  if (corrector_) return;
  for (std::size_t m = 0; m < plant_.mechanisms.size(); ++m) {
    Mechanism& mechanism = plant_.mechanisms[m];
    if (!mechanism.predicts() || plant_.mechanism_asleep[m]) continue;
    if (bounded_.binds(m) || !mechanism.is_foreseeable())
      mechanism.prediction().forget();
    else
      mechanism.prediction().end();
  }
}

void Stepper::count_impulses() {
  for (Axis& axis : plant_.acting_axes())
    for (std::size_t k = 0; k < kMoments; ++k) axis.total += axis.law[k] + axis.damped[k];
  for (Touch& touch : plant_.touches) count(touch);
}

}  // namespace visum::dynamics::impulse
