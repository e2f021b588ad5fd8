// The figures that the suite and the benchmarks measure in a world: points, energy, momentum, gaps.
#pragma once

#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::physics {

// A point of a body (p_B in its frame), in W.
Eigen::Vector3d point_of(const world::WorldModel& model, const world::WorldState& state, world::BodyId body,
                         const Eigen::Vector3d& p_B);

// Kinetic, potential in gravity, and of springs; J.
double energy_of(const world::WorldModel& model, const world::WorldState& state);
// Σ m g (path from the world along the joints to the body's centre of mass). Errors of energy are divided by
// it, so that they mean the same for a short and a long chain.
double energy_scale(const world::WorldModel& model);

Eigen::Vector3d momentum_of(const world::WorldModel& model, const world::WorldState& state);
// About W's origin.
Eigen::Vector3d angular_momentum_of(const world::WorldModel& model, const world::WorldState& state);
// The largest relative changes of both since the beginning.
struct MomentumDrift {
  MomentumDrift(const world::WorldModel& model, const world::WorldState& state);
  void look(const world::WorldModel& model, const world::WorldState& state);

  const Eigen::Vector3d start, angular_start;
  double linear = 0.0, angular = 0.0;
};
// R J Rᵀ ω, about the body's own centre of mass.
Eigen::Vector3d spin_of(const world::Body& body, const world::BodyState& state);

// The largest distance, m, between a joint's point and the place where the joint holds it.
double max_gap(const world::WorldModel& model, const world::WorldState& state);

}  // namespace visum::physics
