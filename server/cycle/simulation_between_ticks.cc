// What changes a world between ticks, and is told to its observer.
#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "hwparts/powercube/module_bus.h"
#include "server/cycle/simulation.h"
#include "server/cycle/world_edit.h"

namespace visum::cycle {

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
  parts_[part].network.writes().clear();  // what is under way from it comes too late
  tell(now(), recording::LoseController{name_of(part)});
}

std::optional<std::string> Simulation::set_parameter(std::size_t part, const std::string& name,
                                                     const protocol::ParameterValue& value) {
  if (auto reason = parts_[part].part->set_parameter(name, value)) return reason;
  tell(now(), recording::SetParameter{name_of(part), name, value});
  return {};
}

std::optional<std::string> Simulation::write_blackboard(std::size_t part, std::size_t board,
                                                        std::uint64_t offset,
                                                        std::span<const std::byte> data) {
  if (auto reason = parts_[part].part->write_blackboard(board, offset, data)) return reason;
  const auto& name = parts_[part].part->description().blackboards[board].name;
  tell(now(), recording::WriteBlackboard{name_of(part), name, offset, data});
  return {};
}

std::optional<powercube::Telegram> Simulation::handle_telegram(std::size_t part,
                                                               const powercube::Telegram& telegram,
                                                               powercube::BusFraming wire) {
  auto answer = parts_[part].part->modules()->handle(telegram, wire);
  tell(now(), recording::BusTelegram{name_of(part), static_cast<std::uint8_t>(wire),
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

// After a restore: what stands in no snapshot is that of the state that came back, or nothing.
void Simulation::forget_ticks() {
  contacts_.clear();
  follow_parts();
  ring_->begin(state_.tick);
}

bool Simulation::has_snapshot(std::uint64_t number) const {
  return std::ranges::find(snapshots_, number, &Snapshot::number) != snapshots_.end();
}

bool Simulation::restore_snapshot(std::uint64_t number, std::string* why) {
  const auto found = std::ranges::find(snapshots_, number, &Snapshot::number);
  const auto before = now();
  std::string reason = found == snapshots_.end() ? "there is no snapshot " + std::to_string(number)
                                                 : load_all(found->state, found->rest);
  if (!reason.empty()) {
    if (why) *why = std::move(reason);
    return false;
  }
  forget_ticks();
  fault_.clear();
  ++era_;
  tell(before, recording::RestoreSnapshot{number});
  return true;
}

bool Simulation::push(const Push& push) {
  if (pushes_.size() == kMaxPushes) return false;
  pushes_.push_back(push);
  const auto& force = push.wrench.force_n;
  const auto& torque = push.wrench.torque_nm;
  tell(now(), recording::PushBody{push.wrench.body.value,
                                  {force.x(), force.y(), force.z()},
                                  {torque.x(), torque.y(), torque.z()},
                                  push.until_tick});
  return true;
}

void Simulation::add_body(const std::string& yaml) {
  auto changed = scene_;
  scene::add_body(changed, yaml);
  const auto fresh = world::initial_state(changed.world);
  change_scene(std::move(changed));
  for (std::size_t i = state_.bodies.size(); i < fresh.bodies.size(); ++i)
    state_.bodies.push_back(fresh.bodies[i]);
  snapshots_.clear();
  for (auto& kept : state_.engines) kept.clear();  // it counts bodies and shapes
  ++revision_;
  edits_.push_back({true, yaml});
  edited_.push_back(scene_.world.bodies.back().name);
  tell(now(), recording::AddBody{yaml});
}

// A body that came and goes leaves nothing behind: the world is as if it had never been there, and a restored
// one need not make it.
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

std::string Simulation::remove_body(const std::string& name) {
  const auto body = scene_.world.find_body(name);
  if (!body.valid()) return "there is no body '" + name + "'";
  if (auto reason = why_not_removable(scene_.world, body); !reason.empty()) return reason;
  for (const auto& push : pushes_)
    if (push.wrench.body == body && push.until_tick > state_.tick) return "'" + name + "' is being pushed";
  for (const auto& sensor : scene_.sensors)
    if (sensor.body == body) return "it carries the sensor '" + sensor.name + "'";
  auto changed = scene_;
  erase_body(changed.world, body);
  for (auto& sensor : changed.sensors)
    if (sensor.body > body) --sensor.body.value;
  try {
    change_scene(std::move(changed), body);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return error.what();
  }
  state_.bodies.erase(state_.bodies.begin() + body.value);
  std::erase_if(pushes_, [body](const Push& push) { return push.wrench.body == body; });
  for (auto& push : pushes_)
    if (push.wrench.body > body) --push.wrench.body.value;
  snapshots_.clear();
  for (auto& kept : state_.engines) kept.clear();  // it counts bodies and shapes
  ++revision_;
  note_removed(name);
  tell(now(), recording::RemoveBody{name});
  return {};
}

}  // namespace visum::cycle
