// One tick of a whole world: its engines, its kinematic bodies, and continuous collision.
//
// Fast free bodies are left where they first touch something (collision/sweep.h). A linked one cannot be
// moved alone. Where one would pass through something, the tick is made again from its start, with contacts
// that the first try has foreseen: the bodies may come as near as to touch.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/config/profile.h"
#include "server/collision/collision.h"
#include "server/dynamics/coupling.h"
#include "server/world/placing.h"

namespace visum::dynamics {

// The simulation owns it; tick's thread. `model` and `collision` must outlive it. A step fails where an
// engine fails.
class WorldStep {
 public:
  WorldStep(const world::WorldModel& model, collision::CollisionStage& collision)
      : model_(model), collision_(collision), kinematic_(world::kinematic_tree(model)), coupling_(model) {}

  struct Tick {
    std::span<const std::unique_ptr<Engine>> engines;
    double tick_s;
    std::span<const hwparts::JointDrive> drives;  // by JointId
    std::span<const Wrench> wrenches;
    std::function<void(std::uint32_t)> entering = {};  // is told the number of each engine before it steps
    config::Profile* profile = nullptr;                // may be none
  };
  // Moves `state` by one tick, from `before`, which is the same at first. `contacts` are those of the last
  // find() of the collision stage; they get their forces, and foreseen ones that acted join them. Warns where
  // kMostTries were not enough.
  StepResult make(const Tick& tick, const world::WorldState& before,
                  std::vector<collision::Contact>& contacts, world::WorldState& state);

  static constexpr int kMostTries = 6;

 private:
  StepResult try_once(const Tick& tick, const world::WorldState& before,
                      std::span<collision::Contact> contacts, world::WorldState& state);
  // Returns whether the tick should be tried again, with what is then added to `contacts`, if there are any.
  bool foresee(const Tick& tick, const world::WorldState& before, const world::WorldState& state,
               std::vector<collision::Contact>* contacts);

  const world::WorldModel& model_;
  collision::CollisionStage& collision_;
  const world::KinematicTree kinematic_;
  Coupling coupling_;
  collision::FastBodies fast_;  // in the last try
};

}  // namespace visum::dynamics
