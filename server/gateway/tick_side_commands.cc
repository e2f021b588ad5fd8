// The commands of the TickSide, which it answers between ticks: one function for each kind of request.
#include <algorithm>
#include <utility>

#include "server/cycle/attempt.h"
#include "server/gateway/tick_side.h"
#include "server/world/world_state.h"

namespace visum::gateway {

using protocol::Error;
using protocol::ErrorCode;
using protocol::Ok;
using protocol::Reply;

namespace {

ErrorCode code_of(cycle::Refusal refusal) {
  switch (refusal) {
    case cycle::Refusal::kUnknownName:
      return ErrorCode::kUnknownName;
    case cycle::Refusal::kBadValue:
      return ErrorCode::kBadValue;
    case cycle::Refusal::kWrongState:
      return ErrorCode::kWrongState;
    case cycle::Refusal::kFull:
    case cycle::Refusal::kNoMemory:
      return ErrorCode::kBusy;
    case cycle::Refusal::kNone:
    case cycle::Refusal::kDamaged:
      break;
  }
  return ErrorCode::kInternal;
}

Error error_of(const cycle::Outcome& refused) {
  return {code_of(refused.refusal()), refused.text(), {}};
}

}  // namespace

void TickSide::run(std::unique_ptr<Command> command) {
  if (const auto* step = std::get_if<protocol::Step>(&command->request)) {
    if (started_ && !paused_) {
      command->reply = Error{ErrorCode::kWrongState, "Step works while the time is paused", {}};
    } else if (step_command_) {
      command->reply = Error{ErrorCode::kBusy, "another Step is still running", {}};
    } else if (simulation_.frozen()) {
      command->reply = Error{ErrorCode::kFrozen, simulation_.fault(), {}};
    } else {
      steps_left_ = step->ticks;
      step_command_ = std::move(command);
      return;
    }
    done_.push_back(std::move(command));
    return;
  }
  // The client's writes that came before this request take effect before it.
  apply_inputs();
  if (std::holds_alternative<protocol::AddBody>(command->request) ||
      std::holds_alternative<protocol::RemoveBody>(command->request)) {
    if (!changes_.full()) return changes_.begin(std::move(command));
    command->reply = Error{ErrorCode::kBusy, "too many changes of the bodies are under way", {}};
  } else {
    const auto outcome = cycle::attempt(cycle::Refusal::kDamaged, [&] {
      command->reply =
          std::visit([&](const auto& request) { return answer(*command, request); }, command->request);
    });
    if (!outcome.done()) command->reply = error_of(outcome);
  }
  done_.push_back(std::move(command));
}

// Inputs that came before the change is ready act before it: a push knows its body by the old numbers.
void TickSide::finish_changes() {
  while (changes_.ready()) {
    apply_inputs();
    auto [command, outcome] = changes_.finish();
    command->reply = outcome.done() ? Reply(Ok{}) : Reply(error_of(outcome));
    done_.push_back(std::move(command));
    ++version_;
  }
}

Reply TickSide::answer(Command&, const protocol::Pause&) {
  started_ = paused_ = true;
  return Ok{};
}

Reply TickSide::answer(Command&, const protocol::Resume&) {
  if (simulation_.frozen()) return Error{ErrorCode::kFrozen, simulation_.fault(), {}};
  started_ = true;
  paused_ = false;
  finish_steps();
  return Ok{};
}

Reply TickSide::answer(Command&, const protocol::SetSpeed& request) {
  pacer_.set_speed(request.factor, Clock::now());
  return Ok{};
}

Reply TickSide::answer(Command&, const protocol::Reset&) {
  simulation_.reset();
  for (auto& watch : watches_) watch.last_tick = simulation_.tick_count();
  return Ok{};
}

Reply TickSide::answer(Command&, const protocol::TakeSnapshot&) {
  const auto number = simulation_.take_snapshot();
  return protocol::SnapshotTaken{number, simulation_.tick_count(), simulation_.state_hash()};
}

Reply TickSide::answer(Command&, const protocol::RestoreSnapshot& request) {
  if (const auto outcome = simulation_.restore_snapshot(request.snapshot); !outcome.done())
    return error_of(outcome);
  for (auto& watch : watches_) watch.last_tick = simulation_.tick_count();
  return Ok{};
}

Reply TickSide::answer(Command& command, const protocol::GetParameters&) {
  return protocol::ParameterList{simulation_.parts()[command.part].part->parameters()};
}

Reply TickSide::answer(Command& command, const protocol::SetParameter& request) {
  const auto outcome = simulation_.set_parameter(command.part, request.name, request.value);
  if (!outcome.done()) return error_of(outcome);
  return Ok{};
}

Reply TickSide::answer(Command& command, const protocol::ReadBlackboard& request) {
  const auto& part = *simulation_.parts()[command.part].part;
  const auto& boards = part.description().blackboards;
  const auto board = std::ranges::find(boards, request.name, &protocol::Blackboard::name) - boards.begin();
  const auto bytes = part.read_blackboard(static_cast<std::size_t>(board));
  if (request.offset > bytes.size())
    return Error{
        ErrorCode::kBadValue, "'" + request.name + "' has " + std::to_string(bytes.size()) + " bytes", {}};
  const auto rest = bytes.subspan(request.offset);
  const auto wanted =
      request.length == 0 ? rest : rest.first(std::min<std::size_t>(request.length, rest.size()));
  return protocol::BlackboardData{
      request.offset, bytes.size(), {wanted.begin(), wanted.end()}, world::hash_bytes(bytes)};
}

Reply TickSide::answer(Command& command, const protocol::WriteBlackboard& request) {
  const auto& boards = simulation_.parts()[command.part].part->description().blackboards;
  const auto board = std::ranges::find(boards, request.name, &protocol::Blackboard::name) - boards.begin();
  const auto outcome = simulation_.write_blackboard(command.part, static_cast<std::size_t>(board),
                                                    request.offset, request.data);
  if (!outcome.done()) return error_of(outcome);
  return Ok{};
}

template <typename Other>
Reply TickSide::answer(Command&, const Other&) {
  return Error{ErrorCode::kInternal, "this request is no command", {}};
}

}  // namespace visum::gateway
