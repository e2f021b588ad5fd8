// Simulation: bodies that come and go while it runs. body_change.h says how.
#include <algorithm>
#include <string>
#include <utility>

#include "server/cycle/attempt.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

BodyChange Simulation::begin_change(bool comes, std::string text) const {
  BodyChange change;
  change.edit = {comes, std::move(text)};
  change.scene = scene_;
  change.sensors = sensors_;
  return change;
}

BodyChange Simulation::begin_reset(protocol::ResetScope scope) const {
  BodyChange change;
  change.reset = scope;
  change.scene = scene_;
  change.sensors = sensors_;
  if (edits_.empty()) return change;
  change.original = original_;
  for (const auto& noted : edits_)
    if (noted.edit.came) change.spawned.push_back(noted.came);
  return change;
}

Outcome Simulation::reset_now(protocol::ResetScope scope) {
  if (scope != protocol::ResetScope::kSpawned && scope != protocol::ResetScope::kAll) {
    reset(scope);
    return {};
  }
  auto change = begin_reset(scope);
  if (auto outcome = prepare(change); !outcome.done()) return outcome;
  return change_bodies(change);
}

// The bodies of the scene that are still there stay as they are.
Outcome Simulation::take_original(BodyChange& change) {
  if (!change.original) return {};  // nothing came or went
  world::WorldState changed = state_;
  const auto outcome = attempt(Refusal::kWrongState, [&] {
    changed.bodies = change.initial;
    for (std::size_t i = 0; i < change.kept.size(); ++i)
      if (change.kept[i].valid()) changed.bodies[i] = state_.bodies[change.kept[i].index()];
    change.machinery.engines = make_engines(*change.changed);
    change.machinery.ring->begin(state_.tick);
    use(change.machinery);
  });
  if (!outcome.done()) return outcome;
  const auto number_now = [&](world::BodyId body) {
    const auto found = std::ranges::find(change.kept, body);
    return found == change.kept.end() ? world::BodyId{}
                                      : world::BodyId{static_cast<std::int32_t>(found - change.kept.begin())};
  };
  for (auto& push : pushes_) push.wrench.body = number_now(push.wrench.body);
  for (auto& pull : pulls_) pull.body = number_now(pull.body);
  std::erase_if(pushes_, [](const Push& push) { return !push.wrench.body.valid(); });
  std::erase_if(pulls_, [](const Pull& pull) { return !pull.body.valid(); });
  scene_ = change.changed;
  state_ = std::move(changed);
  world::measure_joints(model(), state_);
  edits_.clear();
  snapshots_.clear();
  for (auto& kept : state_.engines) kept.clear();
  ++revision_;
  return {};
}

Outcome Simulation::reset_bodies(BodyChange& change) {
  const auto before = now();
  if (auto outcome = take_original(change); !outcome.done()) return outcome;
  if (*change.reset == protocol::ResetScope::kAll) take_back(protocol::ResetScope::kWorld);
  tell(before, recording::Reset{*change.reset});
  return {};
}

Outcome Simulation::change_now(bool comes, const std::string& text) {
  auto change = begin_change(comes, text);
  if (auto outcome = prepare(change); !outcome.done()) return outcome;
  return change_bodies(change);
}

// All that may fail comes first, so that a change is whole or none.
Outcome Simulation::change_bodies(BodyChange& change) {
  if (change.scene != scene_) return {Refusal::kWrongState, "the bodies have changed meanwhile"};
  if (change.reset) return reset_bodies(change);
  const auto gone = change.gone;
  for (const auto& push : pushes_)
    if (gone.valid() && push.wrench.body == gone && push.until_tick > state_.tick)
      return {Refusal::kWrongState, "'" + change.edit.text + "' is being pushed"};
  if (change.edit.came && change.edit.text.size() + edit_bytes() > kMaxEditBytes)
    return {Refusal::kFull, "the bodies that came have more than " + std::to_string(kMaxEditBytes) +
                                " bytes of text together"};
  NotedEdit noted;
  const auto outcome = attempt(change.edit.came ? Refusal::kBadValue : Refusal::kWrongState, [&] {
    noted = {change.edit, change.edit.came ? change.changed->world.bodies.back().name : std::string()};
    edits_.reserve(edits_.size() + 1);
    state_.bodies.reserve(state_.bodies.size() + 1);
    change.machinery.engines = make_engines(*change.changed);
    change.machinery.ring->take_over(*ring_, state_.tick, gone);
    use(change.machinery);
  });
  if (!outcome.done()) return outcome;
  if (!original_) original_ = scene_;
  scene_ = std::move(change.changed);
  if (change.edit.came)
    state_.bodies.push_back(change.came);
  else
    erase_from_state(gone);
  snapshots_.clear();
  for (auto& kept : state_.engines) kept.clear();  // what an engine keeps counts bodies and shapes
  ++revision_;
  note(std::move(noted));
  if (change.edit.came)
    tell(now(), recording::AddBody{change.edit.text});
  else
    tell(now(), recording::RemoveBody{change.edit.text});
  return {};
}

std::size_t Simulation::edit_bytes() const {
  std::size_t bytes = 0;
  for (const auto& noted : edits_) bytes += noted.edit.text.size();
  return bytes;
}

void Simulation::erase_from_state(world::BodyId gone) {
  state_.bodies.erase(state_.bodies.begin() + gone.value);
  std::erase_if(pushes_, [gone](const Push& push) { return push.wrench.body == gone; });
  for (auto& push : pushes_)
    if (push.wrench.body > gone) --push.wrench.body.value;
  std::erase_if(pulls_, [gone](const Pull& pull) { return pull.body == gone; });
  for (auto& pull : pulls_)
    if (pull.body > gone) --pull.body.value;
}

// A body that came and went leaves the world as if it had never been there, so that a restored world need not
// make it either.
void Simulation::note(NotedEdit edit) {
  const auto came =
      edit.edit.came ? edits_.end() : std::ranges::find(edits_, edit.edit.text, &NotedEdit::came);
  if (came == edits_.end())
    edits_.push_back(std::move(edit));
  else
    edits_.erase(came);
}

void Simulation::use_original_scene() {
  const auto scene = original_ ? original_ : scene_;
  auto machinery = make_machinery(*scene, sensors_);
  machinery.engines = make_engines(*scene);
  machinery.ring->take_over(*ring_, state_.tick, {});
  use(machinery);
  scene_ = scene;
}

}  // namespace visum::cycle
