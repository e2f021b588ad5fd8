#include "server/dynamics/world_step.h"

#include <algorithm>

namespace visum::dynamics {
namespace {

constexpr double kShortestPart = 1.0 / 64.0;  // of a tick: no part is shorter, but for the last one

// The results of two parts of a tick, together.
void add(StepResult& to, const StepResult& part) {
  to.warned = to.warned || part.warned;
  to.limited = to.limited || part.limited;
  to.fell_short.insert(to.fell_short.end(), part.fell_short.begin(), part.fell_short.end());
  to.work += part.work;
}

}  // namespace

StepResult WorldStep::make(const Tick& tick, const world::WorldState& before,
                           std::vector<collision::Contact>& contacts, world::WorldState& state) {
  StepResult whole = make_part(tick, tick.tick_s, before, contacts, state);
  if (!whole.ok) return whole;
  double share = 1.0;
  {
    const config::ProfileScope measured(tick.profile, config::Profile::kCollision);
    const collision::FastBodies fast = collision_.find_fast(before, state);
    // Engines of plug-ins are called once in a tick.
    const auto may_repeat = [](const std::unique_ptr<Engine>& engine) { return engine->may_repeat(); };
    if (fast.linked && std::ranges::all_of(tick.engines, may_repeat))
      share = collision_.first_crossing(before, state);
    if (fast.free && share == 1.0) collision_.hold_back(before, state);
  }
  if (share < 1.0) return make_in_parts(tick, share, before, contacts, state);
  world::measure_joints(model_, state, tick.tick_s);
  return whole;
}

// The tick is made anew, at first up to `share` of it. Where kMostParts are not enough, what is left of it is
// left out: nothing passes through anything.
StepResult WorldStep::make_in_parts(const Tick& tick, double share, const world::WorldState& before,
                                    std::vector<collision::Contact>& contacts, world::WorldState& state) {
  start_ = before;
  counted_.clear();
  efforts_.assign(state.joints.size(), 0.0);
  StepResult all;
  double left = 1.0;  // share of the tick
  for (int part = 1;; ++part) {
    if (share < 1.0) {
      share = std::min(std::max(share, kShortestPart / left), 1.0);
      state = start_;
      const StepResult made = make_part(tick, share * left * tick.tick_s, start_, contacts, state);
      if (!made.ok) return made;
      add(all, made);
    }
    collision_.hold_back(start_, state);
    world::measure_joints(model_, state, share * left * tick.tick_s);
    count(share * left, contacts, state);
    all.warned = all.warned || (share < 1.0 && part == kMostParts);
    if (share == 1.0 || part == kMostParts) break;
    left *= 1.0 - share;
    start_ = state;
    if (!collision_.find(state, contacts)) return {false, too_many_contacts(model_, contacts)};
    const StepResult rest = make_part(tick, left * tick.tick_s, start_, contacts, state);
    if (!rest.ok) return rest;
    share = collision_.first_crossing(start_, state);
    if (share == 1.0) add(all, rest);
  }
  contacts = counted_;
  for (std::size_t i = 0; i < efforts_.size(); ++i) state.joints[i].effort = efforts_[i];
  return all;
}

StepResult WorldStep::make_part(const Tick& tick, double part_s, const world::WorldState& start,
                                std::span<collision::Contact> contacts, world::WorldState& state) {
  StepResult made =
      coupling_.step(tick.engines, {part_s, contacts, tick.drives, tick.wrenches}, state, tick.entering);
  if (made.ok) world::move_kinematic(model_, kinematic_, part_s, start, state);
  return made;
}

void WorldStep::count(double share, std::span<const collision::Contact> contacts,
                      const world::WorldState& state) {
  for (const collision::Contact& contact : contacts) {
    collision::Contact& counted = counted_.emplace_back(contact);
    counted.normal_force_n *= share;
    counted.force_on_a_W *= share;
    counted.torque_on_a_W *= share;
  }
  for (std::size_t i = 0; i < efforts_.size(); ++i) efforts_[i] += share * state.joints[i].effort;
}

std::string too_many_contacts(const world::WorldModel& model, std::span<const collision::Contact> contacts) {
  const collision::Contact& last = contacts.back();
  return "more than " + std::to_string(contacts.size()) + " contacts in one tick: the last is between '" +
         model.bodies[last.body_a.index()].name + "' and '" + model.bodies[last.body_b.index()].name + "'";
}

}  // namespace visum::dynamics
