// Simulation: the inputs that change a world between ticks. Each is told to the observer once it is done.
#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "hwparts/powercube/module_bus.h"
#include "protocol/config/unknown_name.h"
#include "server/cycle/simulation.h"
#include "server/cycle/world_edit.h"

namespace visum::cycle {
namespace {

// Runs `change`, which throws where the scene, an engine or a sensor cannot bear what was asked for. Memory
// that runs out is no mistake of the request, so that one exception goes on.
template <typename Change>
Outcome attempt(Refusal refusal, const Change& change) {
  try {
    change();
    return {};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return {refusal, error.what()};
  }
}

Outcome unknown_body(const world::WorldModel& model, const std::string& name) {
  std::vector<std::string> known;
  for (const auto& body : model.bodies) known.push_back(body.name);
  return {Refusal::kUnknownName, config::unknown_name("body", name, known)};
}

}  // namespace

std::string_view Simulation::name_of(std::size_t part) const {
  return parts_[part].part->description().name;
}

void Simulation::tell(recording::TimedInput now, const recording::Input& input) {
  if (!observer_) return;
  now.input = input;
  observer_->took(now);
}

void Simulation::write_inputs(std::size_t part, std::size_t first, std::span<const double> values) {
  parts_[part].hear(state_.tick, first, values);
  tell(now(), recording::WriteInputs{name_of(part), static_cast<std::uint32_t>(first), values});
}

void Simulation::lose_controller(std::size_t part) {
  parts_[part].part->controller_lost();
  parts_[part].network.writes().clear();  // the controller's writes that are under way count no more
  tell(now(), recording::LoseController{name_of(part)});
}

Outcome Simulation::set_parameter(std::size_t part, const std::string& name,
                                  const protocol::ParameterValue& value) {
  if (auto outcome = outcome_of(parts_[part].part->set_parameter(name, value)); !outcome.done())
    return outcome;
  tell(now(), recording::SetParameter{name_of(part), name, value});
  return {};
}

Outcome Simulation::write_blackboard(std::size_t part, std::size_t board, std::uint64_t offset,
                                     std::span<const std::byte> data) {
  if (auto outcome = outcome_of(parts_[part].part->write_blackboard(board, offset, data)); !outcome.done())
    return outcome;
  const auto& name = parts_[part].part->description().blackboards[board].name;
  tell(now(), recording::WriteBlackboard{name_of(part), name, offset, data});
  return {};
}

std::optional<powercube::Telegram> Simulation::handle_telegram(std::size_t part,
                                                               const powercube::Telegram& telegram,
                                                               powercube::BusFraming framing) {
  auto answer = parts_[part].part->modules()->handle(telegram, framing);
  tell(now(), recording::BusTelegram{name_of(part), static_cast<std::uint8_t>(framing),
                                     static_cast<std::uint8_t>(telegram.kind), telegram.module,
                                     std::as_bytes(telegram.message.bytes())});
  return answer;
}

void Simulation::reset() {
  const auto before = now();
  faults_.clear_all();
  hand_out_faults();
  for (auto& bound : parts_) bound.part->reset();
  start_state();
  ++era_;
  tell(before, recording::Reset{});
}

std::uint64_t Simulation::take_snapshot() {
  if (snapshots_.size() == kMaxSnapshots) snapshots_.erase(snapshots_.begin());
  auto& snapshot = snapshots_.emplace_back(Snapshot{next_snapshot_++, state_, {}});
  save_rest(snapshot.rest);
  tell(now(), recording::TakeSnapshot{snapshot.number});
  return snapshot.number;
}

void Simulation::follow_parts() {
  for (auto& bound : parts_) {
    bound.part->following_errors(bound.following_errors);
    for (std::size_t i = 0; i < bound.joints.size(); ++i)
      following_errors_[bound.joints[i].index()] = bound.following_errors[i];
  }
}

void Simulation::forget_ticks() {
  contacts_.clear();
  follow_parts();
  ring_->begin(state_.tick);
}

Outcome Simulation::restore_snapshot(std::uint64_t number) {
  const auto found = std::ranges::find(snapshots_, number, &Snapshot::number);
  if (found == snapshots_.end())
    return {Refusal::kUnknownName, "there is no snapshot " + std::to_string(number)};
  const auto before = now();
  if (auto outcome = load_all(found->state, found->rest); !outcome.done()) return outcome;
  forget_ticks();
  fault_.clear();
  ++era_;
  tell(before, recording::RestoreSnapshot{number});
  return {};
}

Outcome Simulation::push(const Push& push) {
  if (pushes_.size() == kMaxPushes) return {Refusal::kFull, "too many pushes act at once"};
  pushes_.push_back(push);
  const auto& force = push.wrench.force_n;
  const auto& torque = push.wrench.torque_nm;
  tell(now(), recording::PushBody{push.wrench.body.value,
                                  {force.x(), force.y(), force.z()},
                                  {torque.x(), torque.y(), torque.z()},
                                  push.until_tick});
  return {};
}

Outcome Simulation::add_body(const std::string& yaml) {
  world::WorldState fresh;
  const auto outcome = attempt(Refusal::kBadValue, [&] {
    auto changed = scene_;
    scene::add_body(changed, yaml);
    fresh = world::initial_state(changed.world);
    change_scene(std::move(changed));
  });
  if (!outcome.done()) return outcome;
  for (std::size_t i = state_.bodies.size(); i < fresh.bodies.size(); ++i)
    state_.bodies.push_back(fresh.bodies[i]);
  snapshots_.clear();
  for (auto& kept : state_.engines) kept.clear();  // what an engine keeps counts bodies and shapes
  ++revision_;
  edits_.push_back({true, yaml});
  edited_.push_back(scene_.world.bodies.back().name);
  tell(now(), recording::AddBody{yaml});
  return {};
}

// A body that came and went leaves the world as if it had never been there, so that a restored world need not
// make it either.
void Simulation::note_removed(const std::string& name) {
  const auto came = std::ranges::find(edited_, name);
  if (came == edited_.end()) {
    edits_.push_back({false, name});
    edited_.emplace_back();
    return;
  }
  edits_.erase(edits_.begin() + (came - edited_.begin()));
  edited_.erase(came);
}

Outcome Simulation::remove_body(const std::string& name) {
  const auto body = scene_.world.find_body(name);
  if (!body.valid()) return unknown_body(scene_.world, name);
  if (auto outcome = can_remove(scene_.world, body); !outcome.done()) return outcome;
  for (const auto& push : pushes_)
    if (push.wrench.body == body && push.until_tick > state_.tick)
      return {Refusal::kWrongState, "'" + name + "' is being pushed"};
  for (const auto& sensor : scene_.sensors)
    if (sensor.body == body)
      return {Refusal::kWrongState, "'" + name + "' carries the sensor '" + sensor.name + "'"};
  auto changed = scene_;
  erase_body(changed.world, body);
  for (auto& sensor : changed.sensors)
    if (sensor.body > body) --sensor.body.value;
  const auto outcome = attempt(Refusal::kWrongState, [&] { change_scene(std::move(changed), body); });
  if (!outcome.done()) return outcome;
  state_.bodies.erase(state_.bodies.begin() + body.value);
  std::erase_if(pushes_, [body](const Push& push) { return push.wrench.body == body; });
  for (auto& push : pushes_)
    if (push.wrench.body > body) --push.wrench.body.value;
  snapshots_.clear();
  for (auto& kept : state_.engines) kept.clear();  // what an engine keeps counts bodies and shapes
  ++revision_;
  note_removed(name);
  tell(now(), recording::RemoveBody{name});
  return {};
}

}  // namespace visum::cycle
