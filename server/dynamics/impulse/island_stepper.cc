#include "server/dynamics/impulse/island_stepper.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostChanges = 12;       // repetitions because laws reached or left their limit
constexpr std::size_t kMany = 64;      // contacts of free bodies, whose answer may be dear
constexpr double kMostGain = 0.02;     // share of the kinetic energy: rounding gains less than this
constexpr double kStuck = 1e-5;        // m/s, rad/s: a row that nothing can move misses no more than this
constexpr double kSticksFirmly = 0.5;  // share of dry friction: what gave less in the last tick sticks on
constexpr double kStandsStill = 1e-4;  // rad/s, m/s
constexpr int kFreeChanges = 2;        // repetitions before a law that still changes becomes a row

}  // namespace

// A pure torque for an angle; for a distance a force at the joint's point, with its torque about each centre
// of mass.
void IslandStepper::push_axis(const Axis& axis, double impulse) {
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
void IslandStepper::push() {
  Bodies& bodies = plant_.bodies;
  for (const std::size_t k : plant_.islands.wrenches(island_)) {
    const Wrench& wrench = plan_.wrenches[k];
    const auto i = static_cast<std::size_t>(bodies.number(wrench.body));
    bodies.v[i] += 0.5 * plan_.h * bodies.constants[i].inverse_mass * wrench.force_n;
    bodies.w[i] += 0.5 * plan_.h * (bodies.inverse_inertia[i] * wrench.torque_nm);
  }
  plant_.for_axes(island_, [&](const Axis& axis) {
    if (axis.feedforward != 0.0 && (plan_.iterates || axis.node < 0))
      push_axis(axis, 0.5 * plan_.h * axis.feedforward);
  });
}

// The tree's axes only: axes that close loops are pushed by push().
bool IslandStepper::push_known(std::size_t m, Moment moment) {
  bool any = false;
  for (const Axis& axis : plant_.acting_axes_of(m)) {
    if (axis.node < 0) continue;
    const double impulse = known_impulse(axis, moment, plan_.h);
    if (impulse == 0.0) continue;
    plant_.mechanisms[m].tree().push_axis(static_cast<std::size_t>(axis.node), impulse);
    any = true;
  }
  return any;
}

// A moment is solved again only where a law changes how it takes part; without acting axes nothing need be
// saved.
void IslandStepper::save_velocities() {
  bool any = false;
  for (const std::size_t m : mechanisms())
    for (std::size_t k = plant_.first_acting[m]; k < plant_.first_acting[m + 1]; ++k, any = true)
      kept_.rates[plant_.acting[k]] = plant_.axes[plant_.acting[k]].rate;
  if (!any) return;
  copy(plant_.bodies.v, kept_.v);
  copy(plant_.bodies.w, kept_.w);
}

void IslandStepper::restore_velocities() {
  for (const std::size_t m : mechanisms())
    for (std::size_t k = plant_.first_acting[m]; k < plant_.first_acting[m + 1]; ++k)
      plant_.axes[plant_.acting[k]].rate = kept_.rates[plant_.acting[k]];
  copy(kept_.v, plant_.bodies.v);
  copy(kept_.w, plant_.bodies.w);
}

// The bodies of a mechanism often have numbers in a row, and are copied at once.
void IslandStepper::copy(const std::vector<Vector3d>& from, std::vector<Vector3d>& to) const {
  const std::span<const std::size_t> of = bodies();
  if (of.empty()) return;
  const std::size_t first = of.front(), count = of.back() + 1 - first;
  if (count == of.size())
    std::memcpy(static_cast<void*>(&to[first]), static_cast<const void*>(&from[first]),
                count * sizeof(Vector3d));
  else
    for (const std::size_t i : of) to[i] = from[i];
}

void IslandStepper::factor(std::size_t island) {
  island_ = island;
  factor(kAhead);
}

void IslandStepper::factor(Moment moment) {
  // The laws must be in the tree before it is factored.
  set_tree_axes(plant_, island_, moment, plan_.h);
  each_awake([&](std::size_t m) {
    Mechanism& mechanism = plant_.mechanisms[m];
    work_.take(mechanism.factor_units());
    const bool changed = mechanism.place(plant_.bodies, state());
    if (!plan_.iterates)
      mechanism.factor(plant_.bodies);
    else if (changed || kept_.prepared_h[m] != plan_.h)
      corrector().prepare(m, plan_.h);
    kept_.prepared_h[m] = plan_.iterates ? plan_.h : 0.0;
  });
}

const JointSpec* IslandStepper::worst_joint(std::size_t m) const {
  return plan_.iterates ? corrector().worst_joint() : plant_.mechanisms[m].worst_joint();
}

bool IslandStepper::is_too_taut() {
  return std::ranges::any_of(mechanisms(), [&](std::size_t m) {
    Mechanism& mechanism = plant_.mechanisms[m];
    return mechanism.notes() && !plant_.mechanism_asleep[m] &&
           mechanism.is_too_taut(plan_.h, plant_.bodies, work_);
  });
}

// A law in the tree may ask for the impossible in two cases. A loop may move the axis on, as a crank moves a
// piston with friction through its dead centre. Or the laws hold so many axes that nothing free is left to
// close the loop. As a row the law knows its limit.
bool IslandStepper::has_laws_to_box(std::size_t m) {
  bool any = false;
  if (plant_.mechanisms[m].loop_count() > 0)
    for (const Axis& axis : plant_.acting_axes_of(m)) any = any || law_in_tree(axis);
  return any;
}

bool IslandStepper::take_laws_as_rows(std::size_t m) {
  if (!has_laws_to_box(m)) return false;
  for (Axis& axis : plant_.acting_axes_of(m)) axis.boxed = axis.boxed || law_in_tree(axis);
  return true;
}

// A servo or friction without compliance holds its axis in the tree, whatever resists. A contact or stop that
// finds nothing else that could give way is ignored, and an arm of such axes would go through a wall. As a
// row the law knows its limit.
bool IslandStepper::take_rigid_laws_as_rows() {
  if (!bounded_.misses_where_stuck(kStuck)) return false;
  bool any = false;
  for (const std::size_t m : mechanisms()) {
    if (!bounded_.binds(m)) continue;
    for (Axis& axis : plant_.acting_axes_of(m)) {
      if (!law_in_tree(axis) || axis.compliance_s != 0.0) continue;
      axis.boxed = any = true;
    }
  }
  return any;
}

// Where contacts push mechanisms about, dry friction in their joints sticks and slides from tick to tick. As
// a law it would change sides, and all would be solved again; beside a stop it would let nothing move the
// stop's row. Friction that gave little and stood still stays in the tree.
void IslandStepper::take_friction_as_rows() {
  if (plan_.iterates || plant_.islands.touches(island_).empty()) return;
  plant_.for_axes(island_, [&](Axis& axis) {
    if (!axis.acts || axis.driven) return;
    const bool sticks =
        std::abs(axis.rate) <= kStandsStill && std::abs(axis.expected) < kSticksFirmly * axis.most;
    if (sticks && !is_within_reach(axis, plan_.h)) return;
    axis.boxed = true;
    axis.at_limit = 0;
  });
}

bool IslandStepper::foresee(std::size_t island, IslandFate& fate) {
  begin(island, fate);
  const std::uint64_t before = work_.taken();
  take_friction_as_rows();
  save_velocities();
  if (!find_impulses()) return false;
  fate.broken = nullptr;
  fate.work[kAhead] = work_.taken() - before;
  return !(plan_.minds_tension && is_too_taut());
}

// Everything is undone that an earlier try has given.
void IslandStepper::begin_ahead(bool again) {
  if (again) restore_velocities();
  fate_->inexact = false;
  reset_impulses(plant_, island_);
  for (const std::size_t m : mechanisms()) plant_.mechanisms[m].begin_step(plan_.h);
  push();
  factor(kAhead);
  measure_springs(plant_, island_, state());
}

// Joint after joint, impulses are far off until the joints have closed.
bool IslandStepper::knows_wedges() const {
  return plant_.setting.solver != "iterate";
}

// A drive whose law is in the tree holds its axis without a limit until the law is found to be at its limit.
// Fingers that close on a thing look wedged until then.
bool IslandStepper::may_mind_wedges() {
  bool may = true;
  plant_.for_axes(island_, [&](const Axis& axis) { may = may && !(axis.driven && law_in_tree(axis)); });
  return may;
}

// Each repetition starts from the saved velocities.
bool IslandStepper::find_impulses() {
  bool settled = false;  // the laws take part as they should
  for (int i = 0; i < kMostChanges; ++i) {
    begin_ahead(i > 0);
    minds_wedges_ = knows_wedges() && i + 1 < kMostChanges && (settled || may_mind_wedges());
    // Collisions change velocities at once; laws that they push over their limit change first.
    if (find_hits(plant_, island_, plan_.h)) {
      const bool sprung = has_sprung_axes();
      if (sprung) factor(kHit);
      hit();
      if (sprung) factor(kAhead);
      if (i + 1 < kMostChanges && change_laws(plant_, island_, kHit, plan_.h, true)) continue;
    }
    // The look-ahead, with rows that may bind. A law of a loop that cannot hold its axis becomes a row.
    bounded_.build(island_, kAhead, plan_.h, fate_->course);
    note_energy();
    if (!look_ahead()) {
      if (fate_->wedged) continue;
      if (i + 1 < kMostChanges && fate_->broken != nullptr && take_laws_as_rows(fate_->mechanism)) continue;
      return false;
    }
    if (i + 1 < kMostChanges && take_rigid_laws_as_rows()) continue;
    bounded_.report();
    // Solved, unless a law now takes part in another way. The iterative solver and late repetitions use rows.
    const bool as_rows = plan_.corrector != nullptr || i >= kFreeChanges;
    if (change_laws(plant_, island_, kAhead, plan_.h, as_rows)) continue;
    // Only a settled answer tells which contacts are wedged, where drives hold axes.
    settled = true;
    if (minds_wedges_ || !knows_wedges() || i + 1 == kMostChanges || !bounded_.mark_wedges()) return true;
    plant_.for_touches(island_, start_ahead);
  }
  fate_->fell_short = true;
  return true;
}

bool IslandStepper::has_sprung_axes() const {
  return std::ranges::any_of(plant_.islands.springs(island_),
                             [&](std::size_t i) { return !plant_.is_loose(plant_.springs[i]); });
}

void IslandStepper::hit() {
  bounded_.build(island_, kHit, plan_.h, fate_->course);
  if (bounded_.has_rows()) bounded_.bounce();
  bounded_.report();
  plant_.for_axes(island_, [&](Axis& axis) { axis.rate = plant_.rate(axis); });
}

// True if anything but gravity and drives may do work: springs, wrenches, bodies of other engines.
bool IslandStepper::is_worked_on() {
  const Islands& islands = plant_.islands;
  return !islands.wrenches(island_).empty() || !islands.springs(island_).empty() || bounded_.is_dragged();
}

void IslandStepper::note_energy() {
  const bool may_gain = !mechanisms().empty() || plant_.islands.touches(island_).size() >= kMany;
  fate_->watched = may_gain && bounded_.has_rows() && !is_worked_on();
  if (!fate_->watched) return;
  const Energy now = energy();
  fate_->energy_before = now.kinetic + now.potential;
}

IslandStepper::Energy IslandStepper::energy() const {
  const Bodies& of = plant_.bodies;
  Energy energy;
  for (const std::size_t i : bodies()) {
    const double mass = of.constants[i].mass;
    energy.kinetic += 0.5 * (mass * of.v[i].squaredNorm() + of.w[i].dot(of.inertia[i] * of.w[i]));
    energy.potential -= mass * plant_.model.gravity.dot(of.x[i]);
    energy.mass += mass;
  }
  return energy;
}

double IslandStepper::given_by_drives() const {
  double given = 0.0;
  plant_.for_axes(island_, [&](const Axis& axis) {
    given += most_work_of_drive(plant_, axis, std::abs(axis.rate), plan_.h);
  });
  return given;
}

// Returns the most that bodies gain as they are driven out of an overlap, J: they are lifted, or, where
// nothing pulls them down, they part.
double IslandStepper::given_by_overlaps(double mass) const {
  const double h = std::abs(plan_.h), gravity = plant_.model.gravity.norm();
  if (gravity > 0.0) return h * kMostPush * mass * gravity;
  double deepest = kSurfaceLayerM;
  for (const std::size_t i : plant_.islands.touches(island_))
    deepest = std::max(deepest, plant_.touches[i].depth);
  const double speed = std::min(kMostPush, deepest / h);
  return 0.5 * mass * speed * speed;
}

// A solution that only comes near an answer may have gained energy: more than rounding, and more than lifting
// overlapping bodies apart takes. Then all motion of the island is slowed down alike, which joints allow.
// Free bodies are watched after an inexact answer only.
void IslandStepper::give_back_energy() {
  if (!fate_->watched || (mechanisms().empty() && !fate_->inexact)) return;
  const Energy now = energy();
  double gained = now.kinetic + now.potential - fate_->energy_before;
  const double most = kMostGain * now.kinetic + given_by_overlaps(now.mass);
  if (!(gained > most)) return;
  gained -= given_by_drives();
  if (!(gained > most)) return;
  // Takes the gain out of the kinetic energy.
  const double share = std::sqrt(std::max(0.0, 1.0 - gained / now.kinetic));
  for (const std::size_t i : bodies()) {
    plant_.bodies.v[i] *= share;
    plant_.bodies.w[i] *= share;
  }
  fate_->fell_short = true;
}

// A mechanism that has moved needs new poses and factors.
void IslandStepper::commit() {
  each_awake([&](std::size_t m) {
    Mechanism& mechanism = plant_.mechanisms[m];
    if (plant_.bodies.commit(mechanism.blocks(), plan_.h, plant_.model.gravity)) mechanism.forget_place();
  });
}

void IslandStepper::match_velocities(std::size_t m, bool first) {
  // The iterative solver sweeps until v_max, or until its budget is spent.
  if (plan_.iterates) {
    const double v_max = plant_.setting.v_max;
    for (int sweep = 0; sweep < plan_.bounds.most_passes; ++sweep) {
      work_.take(plant_.mechanisms[m].units());
      if (corrector().sweep_velocities(m, plan_.h, v_max, sweep) <= v_max) return;
    }
    fate_->fell_short = true;
    return;
  }
  // The direct solver asks for velocities that agree along all joints at once.
  Mechanism& mechanism = plant_.mechanisms[m];
  work_.take(mechanism.units());
  mechanism.clear();
  mechanism.ask_velocities(plant_.bodies);
  ask_axes(plant_, m, kAfter, plan_.h);
  if (first) push_known(m, kAfter);
  give_answer(m, kAfter);
}

// The springs repeat their impulse; contacts meet at one point again.
void IslandStepper::begin_after() {
  push_by_springs(plant_, island_, state(), plan_.h);
  save_velocities();
  meet_touches(plant_, island_);
  start_after();
}

void IslandStepper::start_after() {
  plant_.for_touches(island_, [](Touch& touch) { impulse::start_after(touch); });
}

void IslandStepper::correct(std::size_t island, IslandFate& fate) {
  begin(island, fate);
  const std::uint64_t before = work_.taken();
  commit();
  begin_after();
  if (!find_velocities()) fate.fell_short = true;
  give_back_energy();
  fate.work[kAfter] = work_.taken() - before;
}

bool IslandStepper::find_velocities() {
  for (int i = 0;; ++i) {
    push();
    factor(kAfter);
    each_awake([&](std::size_t m) { match_velocities(m); });
    bounded_.build(island_, kAfter, plan_.h, fate_->course);
    if (bounded_.has_rows()) bounded_.solve();
    if (bounded_.is_inexact()) fate_->inexact = fate_->fell_short = true;
    bounded_.report();
    const bool as_rows = plan_.corrector != nullptr || i >= kFreeChanges;
    const bool changed = change_laws(plant_, island_, kAfter, plan_.h, as_rows);
    const bool wedged = !changed && knows_wedges() && i + 1 < kMostChanges && bounded_.mark_wedges();
    if (!changed && !wedged) return true;
    if (i + 1 == kMostChanges) return false;
    if (wedged) start_after();
    // The laws' impulses at t+h are found anew.
    restore_velocities();
    plant_.for_axes(island_, [](Axis& axis) { axis.law[kAfter] = axis.damped[kAfter] = 0.0; });
    for (const std::size_t m : mechanisms()) plant_.mechanisms[m].prediction().take_back_after();
  }
}

void IslandStepper::count_impulses(std::size_t island) {
  island_ = island;
  plant_.for_axes(island, [](Axis& axis) {
    for (std::size_t k = 0; k < kMoments; ++k) axis.total += axis.law[k] + axis.damped[k];
  });
  plant_.for_touches(island, [](Touch& touch) {
    const Vector3d impulse = touch.impulse[kHit] + touch.impulse[kAhead] + touch.impulse[kAfter];
    touch.total_normal += impulse[0];
    touch.total += touch.frame * impulse;
    if (is_held_from_turning(touch))
      touch.total_twist += touch.frame * (touch.twist[kHit] + touch.twist[kAhead] + touch.twist[kAfter]);
  });
}

// Rows may push something else in the next step, so nothing is foreseen for the joints of a mechanism that
// has them. Nor is it where loops lose their grip.
void IslandStepper::finish(std::size_t island) {
  count_impulses(island);
  if (plan_.corrector == nullptr)
    each_awake([&](std::size_t m) {
      Mechanism& mechanism = plant_.mechanisms[m];
      if (!mechanism.predicts()) return;
      if (bounded_.binds(m) || !mechanism.is_foreseeable())
        mechanism.prediction().forget();
      else
        mechanism.prediction().end();
    });
  carry_touches(plant_, island_, plan_.h);
}

}  // namespace visum::dynamics::impulse
