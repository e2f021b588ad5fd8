// Simulation: bodies and models that come and go while it runs. body_change.h says how.
#include <algorithm>
#include <string>
#include <utility>

#include "server/cycle/attempt.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

using Edit = recording::State::Edit;

BodyChange Simulation::begin(std::shared_ptr<const scene::Scene> base) const {
  BodyChange change;
  change.base = std::move(base);
  change.scene = scene_;
  for (std::size_t i = 0; i < sensors_.size(); ++i)
    change.sensors.emplace_back(scene_->sensors[i].name, sensors_[i]);
  for (const auto& noted : edits_)
    if (!noted.came.empty()) change.came.push_back(noted.came);
  change.ring = ring_;
  change.meshes = meshes_;
  change.make = make_;
  change.tick = state_.tick;
  change.era = era_;
  return change;
}

BodyChange Simulation::begin_change(Edit edit) const {
  auto change = begin(scene_);
  change.edits.push_back(std::move(edit));
  return change;
}

BodyChange Simulation::begin_spawn(scene::SpawnOrder order, std::optional<config::Files> given) const {
  auto change = begin(scene_);
  change.order = std::move(order);
  change.given = std::move(given);
  return change;
}

BodyChange Simulation::begin_reset(protocol::ResetScope scope) const {
  auto change = begin(edits_.empty() ? nullptr : original_);
  change.reset = scope;
  return change;
}

BodyChange Simulation::begin_restore() const {
  auto change = begin(original_ ? original_ : scene_);
  change.restores = true;
  for (const auto& noted : edits_) change.present.push_back(noted.edit);
  return change;
}

Outcome Simulation::reset_now(protocol::ResetScope scope) {
  if (scope != protocol::ResetScope::kSpawned && scope != protocol::ResetScope::kAll) {
    reset(scope);
    return {};
  }
  return change_now(begin_reset(scope));
}

Outcome Simulation::change_now(BodyChange change) {
  if (auto outcome = prepare(change); !outcome.done()) return outcome;
  return change_bodies(change);
}

// Puts the parts of models that came behind the others, in the order of the changed scene. `change` has those
// afterwards that are not in use any more.
void Simulation::exchange_parts(BodyChange& change) {
  auto& before = change.parts_before;
  auto& numbers = change.part_numbers;
  for (std::size_t i = 0; i < own_parts_; ++i) numbers[i] = static_cast<std::uint32_t>(i);
  for (std::size_t i = own_parts_; i < parts_.size(); ++i) before.push_back(std::move(parts_[i]));
  parts_.resize(own_parts_);
  auto made = change.parts.begin();
  for (const auto& model : change.changed->spawned) {
    const auto count = model.parts.size() + model.sensors.size();
    if (!change.keeps(model)) {
      for (std::size_t i = 0; i < count; ++i) parts_.push_back(std::move(*made++));
      continue;
    }
    std::size_t first = 0;
    for (const auto& other : change.scene->spawned) {
      if (other.name == model.name) break;
      first += other.parts.size() + other.sensors.size();
    }
    for (std::size_t i = first; i < first + count; ++i) {
      numbers[own_parts_ + i] = static_cast<std::uint32_t>(parts_.size());
      parts_.push_back(std::move(before[i]));
    }
  }
  std::swap(change.parts, before);
  faults_.renumber_parts(numbers);
  bind_joints(*change.changed);
}

// Joints get other numbers where a model before them went.
void Simulation::bind_joints(const scene::Scene& scene) {
  for (std::size_t i = own_parts_; i < parts_.size(); ++i) {
    auto& bound = parts_[i];
    const auto& name = bound.part->description().name;
    const auto plan = std::ranges::find_if(
        scene.parts, [&](const scene::PartPlan& one) { return one.context.name == name; });
    if (plan == scene.parts.end()) continue;  // a sensor
    const auto joints = bound.part->joints();
    for (std::size_t joint = 0; joint < joints.size(); ++joint)
      bound.joints[joint] = plan->joints[joints[joint]];
  }
}

// Bodies that stay go on as they are, and `change.initial` has the old state afterwards.
void Simulation::exchange_state(BodyChange& change) {
  auto& next = change.initial;
  for (std::size_t i = 0; i < change.kept.size(); ++i)
    if (change.kept[i].valid()) next.bodies[i] = state_.bodies[change.kept[i].index()];
  for (std::size_t i = 0; i < change.kept_joints.size(); ++i)
    if (change.kept_joints[i].valid()) next.joints[i] = state_.joints[change.kept_joints[i].index()];
  std::swap(state_.bodies, next.bodies);
  std::swap(state_.joints, next.joints);
  const auto number_now = [&](world::BodyId body) {
    const auto found = std::ranges::find(change.kept, body);
    return found == change.kept.end() ? world::BodyId{}
                                      : world::BodyId{static_cast<std::int32_t>(found - change.kept.begin())};
  };
  for (auto& push : pushes_) push.wrench.body = number_now(push.wrench.body);
  for (auto& pull : pulls_) pull.body = number_now(pull.body);
  std::erase_if(pushes_, [](const Push& push) { return !push.wrench.body.valid(); });
  std::erase_if(pulls_, [](const Pull& pull) { return !pull.body.valid(); });
  for (auto& kept : state_.engines) kept.clear();  // what an engine keeps counts bodies and shapes
  for (std::size_t i = 0; i < change.kept.size(); ++i)
    if (change.kept[i].valid() && change.kept[i].index() != i) state_.coupling.clear();  // it counts bodies
}

// All that may fail comes first, so that a change is whole or none.
Outcome Simulation::take(BodyChange& change) {
  const bool comes = !change.noted.empty() && !change.noted.back().came.empty();
  const auto outcome = attempt(comes ? Refusal::kBadValue : Refusal::kWrongState, [&] {
    change.parts_before.reserve(parts_.size() - own_parts_);
    change.part_numbers.assign(parts_.size(), hwparts::FaultSet::kGone);
    edits_.reserve(edits_.size() + change.noted.size());
    parts_.reserve(parts_.size() + change.parts.size());
    if (change.machinery.engines.empty()) change.machinery.engines = make_engines(*change.changed);
    auto& ring = *change.machinery.ring;
    if (change.reset || change.restores || change.era != era_ || change.tick > state_.tick)
      ring.begin(state_.tick);
    else
      ring.copy(*ring_, change.tick, state_.tick, change.kept_joints, change.kept);
    use(change.machinery);
  });
  if (!outcome.done()) return outcome;
  exchange_state(change);
  exchange_parts(change);
  std::swap(sensors_, change.measured);
  if (!original_) original_ = scene_;
  scene_ = change.changed;
  snapshots_.clear();
  ++revision_;
  return {};
}

void Simulation::take_back_from(BodyChange& change) {
  use(change.machinery);
  std::swap(state_.bodies, change.initial.bodies);
  std::swap(state_.joints, change.initial.joints);
  change.part_numbers.assign(parts_.size(), hwparts::FaultSet::kGone);
  for (std::size_t i = 0; i < own_parts_; ++i) change.part_numbers[i] = static_cast<std::uint32_t>(i);
  faults_.renumber_parts(change.part_numbers);
  parts_.resize(own_parts_);
  for (auto& bound : change.parts) parts_.push_back(std::move(bound));
  std::swap(sensors_, change.measured);
  std::swap(edits_, change.noted);
  scene_ = change.scene;
}

Outcome Simulation::reset_bodies(BodyChange& change) {
  const auto before = now();
  if (change.base) {
    if (auto outcome = take(change); !outcome.done()) return outcome;
    edits_.clear();
    world::measure_joints(model(), state_);
  }
  if (*change.reset == protocol::ResetScope::kAll) take_back(protocol::ResetScope::kWorld);
  tell(before, recording::Reset{*change.reset});
  return {};
}

Outcome Simulation::change_bodies(BodyChange& change) {
  if (change.scene != scene_) return {Refusal::kWrongState, "the bodies have changed meanwhile"};
  if (change.reset) return reset_bodies(change);
  for (const auto& push : pushes_) {
    const bool goes = std::ranges::find(change.kept, push.wrench.body) == change.kept.end();
    if (goes && push.until_tick > state_.tick)
      return {Refusal::kWrongState,
              "'" + model().bodies[push.wrench.body.index()].name + "' is being pushed"};
  }
  std::size_t bytes = edit_bytes();
  for (const auto& noted : change.noted) bytes += bytes_of(noted);
  if (bytes > kMaxEditBytes && !change.noted.back().came.empty())
    return {Refusal::kFull, "the bodies and models that came have more than " +
                                std::to_string(kMaxEditBytes) + " bytes of text together"};
  if (auto outcome = take(change); !outcome.done()) return outcome;
  for (auto& noted : change.noted) {
    tell_edit(noted.edit);
    note(std::move(noted));
  }
  return {};
}

void Simulation::tell_edit(const Edit& edit) {
  switch (edit.kind) {
    case Edit::Kind::kBodyCame:
      return tell(now(), recording::AddBody{edit.text});
    case Edit::Kind::kBodyWent:
      return tell(now(), recording::RemoveBody{edit.text});
    case Edit::Kind::kModelCame:
      return tell(now(), recording::SpawnModel{edit.model});
    case Edit::Kind::kModelWent:
      return tell(now(), recording::RemoveModel{edit.text});
  }
}

std::size_t Simulation::bytes_of(const NotedEdit& noted) {
  std::size_t bytes = noted.edit.text.size();
  if (noted.edit.model)
    for (const auto& [path, content] : noted.edit.model->files) bytes += path.size() + content.size();
  return bytes;
}

std::size_t Simulation::edit_bytes() const {
  std::size_t bytes = 0;
  for (const auto& noted : edits_) bytes += bytes_of(noted);
  return bytes;
}

// A thing that came and went leaves the world as if it had never been there, so that a restored world need
// not make it either.
void Simulation::note(NotedEdit edit) {
  const bool goes = edit.came.empty();
  const bool is_model = edit.edit.kind == Edit::Kind::kModelWent;
  const auto came = std::ranges::find_if(edits_, [&](const NotedEdit& other) {
    return other.came == edit.edit.text && (other.edit.kind == Edit::Kind::kModelCame) == is_model;
  });
  if (goes && came != edits_.end())
    edits_.erase(came);
  else
    edits_.push_back(std::move(edit));
}

}  // namespace visum::cycle
