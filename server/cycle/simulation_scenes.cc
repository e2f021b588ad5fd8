// Simulation: another scene takes the place of the world's. scene_change.h says how.
#include <utility>

#include "server/cycle/attempt.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

SceneChange Simulation::begin_load(SceneOrder order) const {
  SceneChange change;
  change.order = std::move(order);
  change.scene = scene_;
  change.make = make_;
  return change;
}

Outcome Simulation::load_scene(std::shared_ptr<const recording::LoadedScene> scene) {
  auto change = begin_load({});
  change.loaded = std::move(scene);
  if (auto outcome = prepare(change); !outcome.done()) return outcome;
  return load_scene(change);
}

// All that may fail comes first.
Outcome Simulation::load_scene(SceneChange& change) {
  auto& next = *change.world;
  const auto outcome = attempt(Refusal::kBadValue, [&] {
    if (next.engines_.empty()) next.engines_ = make_engines(*next.scene_);
    next.parts_.reserve(next.parts_.size() + parts_.size());
  });
  if (!outcome.done()) return outcome;
  const auto before = now();
  exchange_world(next);
  limited_bodies_.clear();
  snapshots_.clear();
  first_snapshot_ = next_snapshot_;
  ++era_;
  ++revision_;
  ++scene_number_;
  tell(before, recording::LoadScene{change.loaded});
  return {};
}

// Parts that only look on stay behind the scene's own, since they belong to no scene. Counts of what happened
// since the start, observers and numbers of snapshots stay, too.
void Simulation::exchange_world(Simulation& other) {
  std::swap(scene_, other.scene_);
  std::swap(original_, other.original_);
  std::swap(edits_, other.edits_);
  std::swap(state_, other.state_);
  std::swap(before_, other.before_);
  std::swap(parts_, other.parts_);
  std::swap(own_parts_, other.own_parts_);
  std::swap(first_agent_, other.first_agent_);
  std::swap(sensors_, other.sensors_);
  std::swap(agents_, other.agents_);
  std::swap(meshes_, other.meshes_);
  std::swap(engines_, other.engines_);
  std::swap(collision_, other.collision_);
  std::swap(world_step_, other.world_step_);
  std::swap(senses_, other.senses_);
  std::swap(contacts_, other.contacts_);
  std::swap(drives_, other.drives_);
  std::swap(following_errors_, other.following_errors_);
  std::swap(contact_forces_, other.contact_forces_);
  std::swap(pushes_, other.pushes_);
  std::swap(pulls_, other.pulls_);
  std::swap(faults_, other.faults_);
  std::swap(ring_, other.ring_);
  std::swap(work_texts_, other.work_texts_);
  std::swap(fault_, other.fault_);
  for (auto& bound : other.parts_)
    if (bound.onlooker)
      parts_.insert(parts_.begin() + static_cast<std::ptrdiff_t>(own_parts_++), std::move(bound));
}

}  // namespace visum::cycle
