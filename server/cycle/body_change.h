// A change of the bodies that is made ready beside the world: one comes, one goes, or all are as in the scene
// that was loaded.
//
// Reading a body, its meshes and the trees for their collisions can take seconds, and the world need not
// stand meanwhile. Simulation::begin_change() notes between two ticks what shall change. prepare() does the
// work on any thread. Simulation::change_bodies() takes the result between two later ticks.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/recording/state.h"
#include "protocol/reset_scope.h"
#include "server/cycle/machinery.h"
#include "server/cycle/outcome.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum::cycle {

// A plain value that one thread at a time has. It keeps the scenes of before and after alive.
struct BodyChange {
  recording::State::Edit edit;                   // what was asked for, unless it is a reset
  std::optional<protocol::ResetScope> reset;     // kSpawned or kAll
  std::shared_ptr<const scene::Scene> original;  // reset: as it was loaded
  std::vector<std::string> spawned;              // reset: names of the bodies that came since
  std::shared_ptr<const scene::Scene> scene;     // of the world that it began in
  std::span<sensors::Sensor* const> sensors;     // of that world, which must outlive the change

  // prepare() fills these in.
  std::shared_ptr<const scene::Scene> changed;
  world::BodyId gone;     // where a body goes, by the numbers of `scene`
  world::BodyState came;  // where one comes
  // Reset: for each body of `changed` its number in `scene`; invalid: it is back, as in the beginning.
  std::vector<world::BodyId> kept;
  std::vector<world::BodyState> initial;  // reset: of `changed`
  Machinery machinery;                    // of `changed`, without its engines
};

// Quick for a reset where nothing came or went. Refuses what the scene's reader or a sensor refuses, bodies
// that a model, a joint or a sensor needs, and with kNoMemory what the memory does not suffice for. Any
// thread.
Outcome prepare(BodyChange& change);

}  // namespace visum::cycle
