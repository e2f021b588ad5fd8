// A change of the bodies that is made ready beside the world: one comes, or one goes.
//
// Reading a body, its meshes and the trees for their collisions can take seconds, and the world need not
// stand meanwhile. Simulation::begin_change() notes between two ticks what shall change. prepare() does the
// work on any thread. Simulation::change_bodies() takes the result between two later ticks.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "protocol/recording/state.h"
#include "server/cycle/machinery.h"
#include "server/cycle/outcome.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum::cycle {

// A plain value that one thread at a time has. It keeps the scenes of before and after alive.
struct BodyChange {
  recording::State::Edit edit;                // what was asked for
  std::shared_ptr<const scene::Scene> scene;  // of the world that it began in
  std::span<sensors::Sensor* const> sensors;  // of that world, which must outlive the change

  // prepare() fills these in.
  std::shared_ptr<const scene::Scene> changed;
  world::BodyId gone;     // where a body goes, by the numbers of `scene`
  world::BodyState came;  // where one comes
  Machinery machinery;    // of `changed`, without its engines
};

// Refuses what the scene's reader or a sensor refuses, bodies that a model, a joint or a sensor needs, and
// with kNoMemory what the memory does not suffice for. Any thread.
Outcome prepare(BodyChange& change);

}  // namespace visum::cycle
