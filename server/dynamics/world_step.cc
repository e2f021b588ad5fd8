#include "server/dynamics/world_step.h"

#include <algorithm>

namespace visum::dynamics {

StepResult WorldStep::make(const Tick& tick, const world::WorldState& before,
                           std::vector<collision::Contact>& contacts, world::WorldState& state) {
  StepResult made = try_once(tick, before, contacts, state);
  std::uint64_t work = made.work;
  for (int tries = 1; made.ok; ++tries) {
    const bool is_last = tries == kMostTries;
    if (!foresee(tick, before, state, is_last ? nullptr : &contacts)) break;
    if (is_last) {
      made.warned = true;
      break;
    }
    state = before;
    made = try_once(tick, before, contacts, state);
    work += made.work;
  }
  if (!made.ok) return made;
  made.work = work;
  collision_.finish_foreseen(contacts);
  if (fast_.free) {
    const config::ProfileScope measured(tick.profile, config::Profile::kCollision);
    collision_.hold_back(before, state);
  }
  world::measure_joints(model_, state, tick.tick_s);
  return made;
}

StepResult WorldStep::try_once(const Tick& tick, const world::WorldState& before,
                               std::span<collision::Contact> contacts, world::WorldState& state) {
  StepResult made =
      coupling_.step(tick.engines, {tick.tick_s, contacts, tick.drives, tick.wrenches}, state, tick.entering);
  if (made.ok) world::move_kinematic(model_, kinematic_, tick.tick_s, before, state);
  return made;
}

// Engines of plug-ins are called once in a tick, so nothing is foreseen where there is one.
bool WorldStep::foresee(const Tick& tick, const world::WorldState& before, const world::WorldState& state,
                        std::vector<collision::Contact>* contacts) {
  const config::ProfileScope measured(tick.profile, config::Profile::kCollision);
  const auto may_repeat = [](const std::unique_ptr<Engine>& engine) { return engine->may_repeat(); };
  fast_ = collision_.find_fast(before, state);
  return fast_.linked && std::ranges::all_of(tick.engines, may_repeat) &&
         collision_.foresee(before, state, contacts);
}

}  // namespace visum::dynamics
