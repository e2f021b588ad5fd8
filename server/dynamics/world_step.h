// One tick of a whole world: its engines, its kinematic bodies, and continuous collision.
//
// Fast free bodies are left where they first touch something (collision/sweep.h). A linked one cannot be
// moved alone. So where a linked body would pass through something within the tick, the tick is made in
// parts: up to the touch, then, with the contacts of that moment, what is left of it. All bodies take part in
// them, so that what a gripper holds stays in it.
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
// engine fails, or where a part of a tick has more contacts than a world may have.
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
  // Moves `state` by one tick, from `before`, which is the same at first. `contacts` are those of that
  // moment, and get their forces. Where the tick is made in parts, they are those of all parts; forces and
  // efforts are means over the tick. Warns where kMostParts are not enough; what was left of the tick is then
  // left out.
  StepResult make(const Tick& tick, const world::WorldState& before,
                  std::vector<collision::Contact>& contacts, world::WorldState& state);

  static constexpr int kMostParts = 8;  // of one tick

 private:
  // Moves everything by `part_s`, through whatever is in the way.
  StepResult make_part(const Tick& tick, double part_s, const world::WorldState& start,
                       std::span<collision::Contact> contacts, world::WorldState& state);
  StepResult make_in_parts(const Tick& tick, double share, const world::WorldState& before,
                           std::vector<collision::Contact>& contacts, world::WorldState& state);
  // Takes the forces of a part into account, as means over the tick.
  void count(double share, std::span<const collision::Contact> contacts, const world::WorldState& state);

  const world::WorldModel& model_;
  collision::CollisionStage& collision_;
  const world::KinematicTree kinematic_;
  Coupling coupling_;
  // For a tick in parts:
  world::WorldState start_;                  // of the part
  std::vector<collision::Contact> counted_;  // of all parts so far
  std::vector<double> efforts_;              // by JointId
};

// Says that a world has more contacts than it may have. `contacts`: those that were found, not empty.
std::string too_many_contacts(const world::WorldModel& model, std::span<const collision::Contact> contacts);

}  // namespace visum::dynamics
