// A pull: a spring with a damper from a point of a body to a target, as a hand drags a thing along.
#pragma once

#include <cstdint>

#include "server/dynamics/engine.h"
#include "server/world/world_state.h"

namespace visum::cycle {

struct Pull {
  world::BodyId body;
  Eigen::Vector3d p_B = Eigen::Vector3d::Zero();       // the point, in the body's link frame
  Eigen::Vector3d target_W = Eigen::Vector3d::Zero();  // m
  double max_force_n = 0.0;                            // > 0
  std::int64_t until_tick = 0;                         // 0: until it is released
  // The session that pulls. It is for whoever ends the pulls of sessions, and no part of the world's state: 0
  // after a restore.
  std::uint64_t owner = 0;
};

// The force of the pull during the next tick. A free body comes to the target as a critically damped
// oscillator of 20 rad/s, or of 0.25 per tick where ticks are longer than 12.5 ms: it is 5 cm away after
// 0.24 s where it was 1 m away. The force is computed for the end of the tick, so it is stable. A body that
// other things hold feels the same force, and is dragged with no more than `max_force_n`.
dynamics::Wrench wrench_of(const Pull& pull, const world::WorldModel& model, const world::WorldState& state,
                           double tick_s);

}  // namespace visum::cycle
