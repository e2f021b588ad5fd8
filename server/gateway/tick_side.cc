#include "server/gateway/tick_side.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <sstream>
#include <tuple>
#include <utility>

namespace visum::gateway {

TickSide::TickSide(cycle::Simulation& simulation, Mailbox& mailbox, bool running_at_once,
                   recording::Archive* archive)
    : simulation_(simulation),
      mailbox_(mailbox),
      pacer_(simulation.model().tick_ns),
      numbers_(simulation),
      changes_(simulation, archive),
      waits_for_changes_(simulation.scene().clock != scene::ClockKind::kRealtime),
      watches_(numbers_.most()),
      stops_(numbers_.most()),
      trips_(numbers_.most()),
      started_(running_at_once) {
  pacer_.set_speed(simulation.scene().speed, Clock::now());
  simulation.release_all_of(0);  // pulls of a world that goes on from a recording: nobody holds them
  inputs_.reserve(Mailbox::kInputs);
  done_.reserve(Mailbox::kCommands);
  find_nodes();
}

void TickSide::find_nodes() {
  nodes_.clear();
  for (const auto& bound : std::as_const(simulation_).parts())
    if (bound.part->node_fault()) nodes_.push_back({bound.part.get()});
}

void TickSide::follow_parts() {
  const auto before = numbers_.table();
  if (!numbers_.follow()) return;
  const auto& now = *numbers_.table();
  if (before->scene_number != now.scene_number) find_nodes();
  for (const auto part : changed_parts(*before, now)) {
    watches_[part] = {};
    trips_[part] = now.slots[part].part->trips();
  }
  if (parts_changed_) parts_changed_(now);
}

void TickSide::empty_mailbox() {
  stopped_.clear();
  finish_changes();
  obey_stops();
  for (Mailbox::Item item; !waits_for_change() && mailbox_.next(item); obey_stops()) {
    if (item.command) {
      const bool went_back = goes_back(item.command->request);
      run(std::unique_ptr<Command>(item.command));
      ++version_;
      // It was on its way before these stops, and has undone them.
      if (went_back)
        for (const auto part : stopped_) stop(part);
      continue;
    }
    if (item.input->kind == Input::Kind::kLeaseGranted) start();
    inputs_.push_back(item.input);
  }
}

bool TickSide::goes_back(const protocol::Request& request) {
  const auto* reset = std::get_if<protocol::Reset>(&request);
  return std::holds_alternative<protocol::RestoreSnapshot>(request) ||
         (reset && reset->scope != protocol::ResetScope::kTime &&
          reset->scope != protocol::ResetScope::kSpawned);
}

void TickSide::give_back() {
  for (auto& command : done_) mailbox_.give_back(std::move(command));
  done_.clear();
  stops_.tell(simulation_.tick_count());
}

void TickSide::obey_stops() {
  if (!stops_.is_pressed()) return;
  stops_.take([this](std::size_t part) {
    stop(static_cast<std::uint32_t>(part));
    stopped_.push_back(static_cast<std::uint32_t>(part));
    if (changes_.under_way()) stopped_meanwhile_.push_back(static_cast<std::uint32_t>(part));
  });
  touch();
}

// A part without an emergency stop stops as if its controller were lost. That ends its lease, since the
// controller's next write would move it on.
void TickSide::stop(std::uint32_t part) {
  const auto index = numbers_.find(part);
  if (!index) return;
  const auto& description = simulation_.parts()[*index].part->description();
  const bool has_stop = std::ranges::find(description.parameters, protocol::kEmergencyStop,
                                          &protocol::Parameter::name) != description.parameters.end();
  if (has_stop && simulation_.set_parameter(*index, protocol::kEmergencyStop, true).done())
    return tell({Notice::Kind::kStopped, part, 0, 0, simulation_.tick_count()});
  if (!description.controller_inputs.empty()) take_from_controller(part, Notice::Kind::kStopped);
}

void TickSide::tick() {
  apply_inputs();
  check_deadlines();
  if (!next_)
    simulation_.tick();
  else if (!next_())
    hold();
  if (next_) follow_parts();  // the recording may have gone to another moment
  watch_nodes();
  measure_speed();
  if (steps_left_ > 0 && (--steps_left_ == 0 || simulation_.frozen())) finish_steps();
}

void TickSide::hold() {
  paused_ = true;
  finish_steps();
  touch();
}

void TickSide::watch_nodes() {
  for (auto& node : nodes_) {
    const bool failed = !node.part->node_fault()->empty();
    if (failed && !node.failed)
      spdlog::error("'{}' is in fault: {}", node.part->description().name, *node.part->node_fault());
    node.failed = failed;
  }
  const auto& parts = simulation_.parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto& part = *parts[i].part;
    auto& trips = trips_[numbers_.table()->slot_of[i]];
    const auto before = std::exchange(trips, part.trips());
    if (before == trips) continue;
    std::istringstream lines(part.trip_text(before));
    for (std::string line; std::getline(lines, line);)
      spdlog::warn("'{}' has tripped: {}", part.description().name, line);
  }
}

void TickSide::apply_inputs() {
  std::ranges::sort(inputs_, {},
                    [](const Input* input) { return std::tuple(input->part, input->epoch, input->arrival); });
  for (Input* input : inputs_) {
    apply(*input);
    mailbox_.give_back(input);
  }
  inputs_.clear();
}

void TickSide::apply(const Input& input) {
  const auto now = simulation_.tick_count();
  const bool is_about_part = input.kind != Input::Kind::kPush && input.kind != Input::Kind::kSessionEnded;
  std::uint32_t index = 0;
  if (is_about_part) {
    const auto found = numbers_.find(input.part, input.generation);
    if (!found) return;  // it went with its model
    index = *found;
  }
  switch (input.kind) {
    case Input::Kind::kWrite:
      if (input.epoch <= watches_[input.part].lost) return;
      if (is_too_old(input)) {
        ++dropped_writes_;
        return tell({Notice::Kind::kWriteDropped, input.part, 0, input.epoch, now});
      }
      simulation_.write_inputs(index, input.first_port, input.values);
      watches_[input.part].last_tick = now;
      return;
    case Input::Kind::kLeaseGranted:
      watches_[input.part] = {input.epoch, input.deadline_ticks, now, true, watches_[input.part].lost};
      return;
    case Input::Kind::kLeaseReleased:
      watches_[input.part].deadline_ticks = 0;
      watches_[input.part].leased = false;
      return;
    case Input::Kind::kLeaseLost:
      end_watch(input.part, input.epoch);
      simulation_.lose_controller(index);
      return;
    case Input::Kind::kPush:
      return apply_push(input);
    case Input::Kind::kFault:
      return apply_fault(input, index);
    case Input::Kind::kSessionEnded:
      return holders_.end(simulation_, input.epoch);
    case Input::Kind::kClearFault:
      return simulation_.clear_faults(index, input.fault_kind, input.fault_drive);
  }
}

// A slow world looks at its inputs rarely; two of its ticks are never too long.
bool TickSide::is_too_old(const Input& write) const {
  if (oldest_write_.count() == 0) return false;
  return Clock::now() - std::max(write.read_at, runs_since_) >
         std::max<Clock::duration>(oldest_write_, 2 * pacer_.period());
}

void TickSide::apply_fault(const Input& input, std::uint32_t part) {
  const auto now = simulation_.tick_count();
  const auto until = input.duration_ticks == 0 ? 0 : now + input.duration_ticks;
  if (!simulation_.inject({part, input.fault, until}).done())
    tell({Notice::Kind::kFaultRefused, input.part, 0, 0, now});
}

void TickSide::apply_push(const Input& input) {
  const auto now = simulation_.tick_count();
  auto wrench = input.wrench;
  const auto& bodies = simulation_.state().bodies;
  const bool pushed = input.revision == simulation_.revision() && [&] {
    if (input.push_point)
      wrench.torque_nm += (*input.push_point - bodies[wrench.body.index()].p_WC).cross(wrench.force_n);
    return simulation_.push({wrench, now + input.duration_ticks}).done();
  }();
  if (!pushed) tell({Notice::Kind::kPushRefused, 0, 0, 0, now});
}

void TickSide::check_deadlines() {
  const auto now = simulation_.tick_count();
  const auto count = numbers_.table()->slots.size();
  for (std::uint32_t part = 0; part < count; ++part) {
    const auto& watch = watches_[part];
    if (watch.deadline_ticks != 0 && now - watch.last_tick > watch.deadline_ticks)
      take_from_controller(part, Notice::Kind::kDeadlineMissed);
  }
}

void TickSide::look_at_sessions() {
  if (!session_watch_.look(mailbox_.beats(), Clock::now())) return;
  for (std::uint32_t part = 0; part < watches_.size(); ++part) {
    if (!watches_[part].leased) continue;
    take_from_controller(part, Notice::Kind::kSilent);
    ++silent_stops_;
    touch();
  }
}

void TickSide::take_from_controller(std::uint32_t part, Notice::Kind why) {
  const auto& watch = watches_[part];
  const auto epoch = watch.epoch;
  const auto index = numbers_.find(part);
  if (!index) return;
  simulation_.lose_controller(*index);
  tell({why, part, 0, watch.leased ? epoch : 0, simulation_.tick_count()});
  end_watch(part, epoch);
}

void TickSide::end_watch(std::uint32_t part, std::uint64_t lost_epoch) {
  watches_[part] = {.lost = std::max(watches_[part].lost, lost_epoch)};
}

void TickSide::tell(Notice notice) {
  notice.generation = numbers_.generation(notice.part);
  mailbox_.tell(notice);
  told_ = true;
}

void TickSide::measure_speed() {
  const auto now = ticked_at_ = Clock::now();
  if (now - measured_at_ < std::chrono::seconds(1)) return;
  const auto sim_ns =
      static_cast<double>((simulation_.tick_count() - measured_tick_) * simulation_.model().tick_ns);
  real_time_factor_ =
      std::max(0.0, sim_ns / std::chrono::duration<double, std::nano>(now - measured_at_).count());
  measured_at_ = now;
  measured_tick_ = simulation_.tick_count();
}

void TickSide::finish_steps() {
  steps_left_ = 0;
  if (!step_command_) return;
  if (simulation_.frozen())
    step_command_->reply = protocol::Error{protocol::ErrorCode::kFrozen, simulation_.fault(), {}};
  else
    step_command_->reply = protocol::Advanced{simulation_.tick_count(), simulation_.sim_time_ns(),
                                              shown_era_ ? shown_era_() : simulation_.era()};
  done_.push_back(std::move(step_command_));
  told_ = true;
}

}  // namespace visum::gateway
