#include "server/dynamics/impulse/stepper.h"

#include <algorithm>
#include <numbers>

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostPasses = 40;  // passes of Newton; each closes the joints to second order
constexpr int kTautCutsLeft =
    3;  // with fewer cuts left, tension asks for no more: where contacts wedge joints it has no end
constexpr double kFirmDMax = 1e-6;  // m, rad: largest gap that a firm step leaves

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

// Mechanisms with loops have a smaller gap. A spring between two bodies of one mechanism closes a loop, too,
// unless it acts on the axis of a joint in the tree.
std::vector<double> find_d_max_by_mechanism(const Plant& plant, const world::EngineSetting& setting) {
  std::vector<double> found(plant.mechanisms.size(), find_d_max(setting, false));
  const double in_loops = find_d_max(setting, true);
  for (std::size_t m = 0; m < found.size(); ++m)
    if (plant.mechanisms[m].loop_count() > 0) found[m] = in_loops;
  const auto mechanism_of = [&](int body) {
    return body < 0 ? -1 : plant.places[static_cast<std::size_t>(body)].mechanism;
  };
  for (const Spring& spring : plant.springs) {
    if (spring.axis != Axis::kNone) continue;
    const int m = mechanism_of(spring.spec.b);
    if (m >= 0 && m == mechanism_of(spring.spec.a)) found[static_cast<std::size_t>(m)] = in_loops;
  }
  return found;
}

StepPlan::Bounds bounds_of(const Plant& plant, const world::EngineSetting& setting) {
  return {find_d_max(setting, false), find_d_max_by_mechanism(plant, setting), kMostPasses};
}

}  // namespace

Stepper::Stepper(Plant& plant)
    : plant_(plant), scratch_(plant), standing_(plant), more_work_(plant.pool.threads() - 1) {
  plan_.bounds = bounds_of(plant, plant.setting);
  steppers_.push_back(std::make_unique<IslandStepper>(plant, plan_, scratch_, plant.work));
  for (WorkBudget& work : more_work_)
    steppers_.push_back(std::make_unique<IslandStepper>(plant, plan_, scratch_, work));
  if (plant.setting.solver != "iterate") return;
  corrector_.emplace(plant);
  plan_.corrector = &*corrector_;
  plan_.iterates = true;
  guard_.start(plant.bodies.size());
  plan_.bounds.most_passes = plant.setting.budget;
  // A firm step is one of the solver `direct`, with its bounds where the setting's are wider.
  world::EngineSetting firm = plant.setting;
  firm.solver = "direct";
  if (firm.d_max > kFirmDMax) firm.d_max = kFirmDMax;
  firm_bounds_ = bounds_of(plant, firm);
  for (Mechanism& mechanism : plant.mechanisms) mechanism.start_noting(plant.bodies);
}

// Sleeping touches are in no island.
void Stepper::load_touches(const StepInput& input, const world::WorldState& state,
                           const WarmStart& warm_start, bool may_stand) {
  // Other kinds of steps than this one are not the same from tick to tick.
  if (may_stand && !corrector_ && plant_.setting.order == 2)
    standing_.find(input.tick_s, input.contacts, warm_start);
  else
    standing_.find_none();
  const auto load = [&](Touch& touch) {
    load_touch(plant_, input.contacts, state, touch);
    warm_start.load(touch);
  };
  const auto load_island = [&](std::size_t, std::size_t i) {
    if (standing_.stands(i)) return;
    plant_.for_touches(i, load);
    note_landings(plant_, i, input.contacts, input.tick_s);
  };
  if (are_side_by_side())
    run_side_by_side(load_island);
  else
    for (std::size_t i = 0; i < plant_.islands.size(); ++i) load_island(0, i);
  if (plant_.setting.sleep_s == 0.0) return;
  for (Touch& touch : plant_.touches)
    if (touch.asleep) load(touch);
}

void Stepper::begin_step(double h, std::span<const Wrench> wrenches, const world::WorldState& state) {
  plan_.h = h;
  plan_.wrenches = wrenches;
  plan_.state = &state;
  fates_.assign(plant_.islands.size(), {});
}

void Stepper::factor(double h, const world::WorldState& state) {
  begin_step(h, {}, state);
  for (std::size_t i = 0; i < plant_.islands.size(); ++i) steppers_[0]->factor(i);
}

// A contact takes a little more than a body with its joint.
std::size_t Stepper::cost(std::size_t i) const {
  const Islands& islands = plant_.islands;
  return 2 * islands.bodies(i).size() + 3 * islands.touches(i).size();
}

void Stepper::read_fates() {
  for (const IslandFate& fate : fates_) {
    fell_short_ = fell_short_ || fate.fell_short;
    if (broken_ == nullptr) broken_ = fate.broken;  // that of the first island
  }
}

void Stepper::move_free() {
  plant_.for_free([&](auto blocks) {
    plant_.bodies.look_ahead(blocks, plan_.h, plant_.model.gravity);
    plant_.bodies.commit(blocks, plan_.h, plant_.model.gravity);
  });
}

void Stepper::count_sleeping() {
  if (plant_.setting.sleep_s == 0.0) return;
  for (Touch& touch : plant_.touches) {
    if (!touch.asleep) continue;
    start_after(touch);
    const Vector3d impulse = touch.impulse[kAhead] + touch.impulse[kAfter];
    touch.total_normal = impulse[0];
    touch.total = touch.frame * impulse;
    touch.total_twist = 2.0 * touch.kept_twist;
  }
}

bool Stepper::stand(IslandStepper& by, std::size_t island, Moment moment) {
  if (!standing_.stands(island)) return false;
  by.take(standing_.work(island, moment));
  standing_.stand(island, moment);
  return true;
}

// Impulses at t, then the bodies move, then velocities at t+h.
bool Stepper::step(double h, std::span<const Wrench> wrenches, const world::WorldState& state,
                   int cuts_left) {
  plant_.work.take(WorkBudget::kPerBody * plant_.bodies.size());
  begin_step(h, wrenches, state);
  plan_.divisible = cuts_left > 0;
  plan_.minds_tension = !plan_.iterates && cuts_left > kTautCutsLeft;
  fell_short_ = firm_;
  broken_ = nullptr;
  if (corrector_) guard_.begin(plant_);
  if (firm_) move_together();
  const bool foreseen = for_islands([this](IslandStepper& by, std::size_t i, IslandFate& fate) {
    return stand(by, i, kAhead) || by.foresee(i, fate);
  });
  read_fates();
  if (!foreseen || (plan_.iterates && !holds_together())) return false;
  move_free();
  for_islands([this](IslandStepper& by, std::size_t i, IslandFate& fate) {
    if (stand(by, i, kAfter)) return true;
    by.correct(i, fate);
    if (!corrector_) by.finish(i);
    return true;
  });
  read_fates();
  if (corrector_) {
    if (!keep_energy()) return false;
    for (std::size_t i = 0; i < plant_.islands.size(); ++i) steppers_[0]->finish(i);
  }
  count_sleeping();
  return true;
}

bool Stepper::step_limited(double h, std::span<const Wrench> wrenches, const world::WorldState& state) {
  begin_step(h, wrenches, state);
  plan_.divisible = false;
  fell_short_ = true;
  short_bodies_.clear();
  guard_.begin(plant_);
  IslandStepper& by = *steppers_[0];
  for (std::size_t i = 0; i < plant_.islands.size(); ++i) {
    by.foresee_limited(i, fates_[i]);
    if (fates_[i].held) guard_.hold(plant_.islands.bodies(i).front());
  }
  move_free();
  for (std::size_t i = 0; i < plant_.islands.size(); ++i) by.correct_limited(i, fates_[i], short_bodies_);
  // Bodies that stay have felt nothing.
  const std::vector<std::size_t> stay = guard_.end(plant_, wrenches, h);
  const auto stays = [&](int body) {
    return body >= 0 && std::ranges::binary_search(stay, static_cast<std::size_t>(body));
  };
  for (Touch& touch : plant_.touches)
    if (!touch.asleep && (stays(touch.a) || stays(touch.b)))
      for (std::size_t k = 0; k < kMoments; ++k) touch.impulse[k] = touch.twist[k] = Vector3d::Zero();
  for (Axis& axis : plant_.acting_axes())
    if (stays(axis.a) || stays(axis.b)) axis.stopped = {};
  short_bodies_.insert(short_bodies_.end(), stay.begin(), stay.end());
  for (std::size_t i = 0; i < plant_.islands.size(); ++i) by.count_impulses(i);
  count_sleeping();
  return stay.empty();
}

}  // namespace visum::dynamics::impulse
