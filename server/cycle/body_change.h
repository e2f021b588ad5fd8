// A change of what is in the world that is made ready beside it: a body or a model comes or goes, all is as
// in the scene that was loaded, or as a saved state has it.
//
// Reading a model, its meshes and the trees for their collisions can take seconds, and the world need not
// stand meanwhile. Simulation::begin_change() and its like note between two ticks what shall change.
// prepare() does the work on any thread. Simulation::change_bodies() takes the result between two later
// ticks.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/recording/state.h"
#include "protocol/reset_scope.h"
#include "server/cycle/bound_part.h"
#include "server/cycle/machinery.h"
#include "server/cycle/outcome.h"
#include "server/scene/scene.h"
#include "server/scene/spawn.h"
#include "server/world/world_state.h"

namespace visum::cycle {

// An edit with the name of what came; empty: something went.
struct NotedEdit {
  recording::State::Edit edit;
  std::string came;
};

// A plain value that one thread at a time has. It keeps the scenes of before and after alive, and the
// machinery and parts that are not in use.
struct BodyChange {
  std::vector<recording::State::Edit> edits;  // from `base`, one after the other
  std::optional<scene::SpawnOrder> order;  // a model that is asked for: prepare() makes the last edit of it
  std::optional<config::Files> given;      // what it is read from, in place of the disk
  std::optional<protocol::ResetScope> reset;  // kSpawned or kAll
  bool restores = false;                      // a saved state is loaded afterwards

  // These are of the world that it began in.
  std::shared_ptr<const scene::Scene> base;  // that scene, or the one that was loaded; null: nothing changes
  std::shared_ptr<const scene::Scene> scene;
  std::vector<std::pair<std::string, sensors::Sensor*>> sensors;  // must outlive the change
  std::vector<std::string> came;                // names of what came since the scene was loaded
  std::vector<recording::State::Edit> present;  // restores: the edits of that world
  std::shared_ptr<const FlightRing> ring;
  std::shared_ptr<collision::PreparedMeshes> meshes;
  PartMaker make;
  std::int64_t tick = 0;
  std::uint64_t era = 0;

  // prepare() fills these in.
  std::shared_ptr<const scene::Scene> changed;
  std::vector<NotedEdit> noted;  // the edits
  // For each body, and joint, of `changed` its number in `scene`; invalid: it is new, and begins as `initial`
  // says.
  std::vector<world::BodyId> kept;
  std::vector<world::JointId> kept_joints;
  world::WorldState initial;
  std::vector<BoundPart> parts;            // of the models that came; once taken, those that went
  std::vector<sensors::Sensor*> measured;  // the sensors of `changed`
  Machinery machinery;                     // of `changed`; its engines may be missing

  // Room for take(), which must not fail once it has begun.
  std::vector<BoundPart> parts_before;
  std::vector<std::uint32_t> part_numbers;  // by the old number of a part

  // True for a model that stays: its parts go on.
  bool keeps(const scene::Spawned& model) const;
};

// Quick where nothing changes. Refuses what the scene's reader or a sensor refuses, bodies that a model, a
// joint or a sensor needs, and with kNoMemory what the memory does not suffice for. Any thread.
Outcome prepare(BodyChange& change);

}  // namespace visum::cycle
