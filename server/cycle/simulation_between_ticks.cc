// Simulation: the inputs that change a world between ticks. Each is told to the observer once it is done.
#include <algorithm>
#include <utility>

#include "hwparts/powercube/module_bus.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {
std::string_view Simulation::name_of(std::size_t part) const {
  return parts_[part].part->description().name;
}

void Simulation::tell(recording::TimedInput now, const recording::Input& input) {
  now.input = input;
  for (auto* observer : {observer_, second_observer_})
    if (observer) observer->took(now);
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
  const auto set = parts_[part].part;  // one that steers a recording may bring another scene
  if (auto outcome = outcome_of(set->set_parameter(name, value)); !outcome.done()) return outcome;
  tell(now(), recording::SetParameter{set->description().name, name, value});
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

void Simulation::reset(protocol::ResetScope scope) {
  const auto before = now();
  take_back(scope);
  tell(before, recording::Reset{scope});
}

void Simulation::take_back(protocol::ResetScope scope) {
  const auto tick = state_.tick;
  if (scope == protocol::ResetScope::kTime) {
    begin_time_anew();
  } else {
    faults_.clear_all();
    hand_out_faults();
    for (auto& bound : parts_) bound.part->reset();
    start_state();
  }
  if (scope == protocol::ResetScope::kState) {
    state_.tick = before_.tick = tick;
    ring_->begin(tick);
  }
  ++era_;
}

// Whatever ends or arrives at a tick does so after as many ticks as before.
void Simulation::begin_time_anew() {
  const auto tick = std::exchange(state_.tick, 0);
  before_.tick = 0;
  for (auto& push : pushes_) push.until_tick -= tick;
  // A pull that ends now is over: 0 would mean that it does not end.
  std::erase_if(pulls_, [tick](const Pull& pull) { return pull.until_tick != 0 && pull.until_tick <= tick; });
  for (auto& pull : pulls_)
    if (pull.until_tick != 0) pull.until_tick -= tick;
  faults_.move_ends(tick);
  for (auto& bound : parts_)
    if (!bound.network.ideal()) bound.network.move_dues(tick);
  ring_->begin(0);
}

std::uint64_t Simulation::take_snapshot() {
  Snapshot snapshot{next_snapshot_, state_, {}};
  save_rest(snapshot.rest);
  snapshots_.reserve(kMaxSnapshots + 1);
  snapshots_.push_back(std::move(snapshot));  // whole, or memory ran out before
  if (snapshots_.size() > kMaxSnapshots) snapshots_.erase(snapshots_.begin());
  const auto number = next_snapshot_++;
  tell(now(), recording::TakeSnapshot{number});
  return number;
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
  if (found == snapshots_.end()) {
    const bool of_before = number > 0 && number < first_snapshot_;
    return {Refusal::kUnknownName, "there is no snapshot " + std::to_string(number) +
                                       (of_before ? ": those of the scene before went with it" : "")};
  }
  const auto before = now();
  if (auto outcome = load_all(found->state, found->rest); !outcome.done()) return outcome;
  pulls_.clear();  // whoever held them has let go
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

}  // namespace visum::cycle
