// The commands of the TickSide, which it answers between ticks: one function for each kind of request.
#include <algorithm>
#include <utility>

#include "protocol/config/unknown_name.h"
#include "server/cycle/attempt.h"
#include "server/cycle/world_edit.h"
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
  if (BodyChanges::takes(command->request)) {
    if (!changes_.full()) {
      if (changes_.begin(std::move(command))) finish_changes();
      return;
    }
    command->reply = Error{ErrorCode::kBusy, "too many changes of the bodies are under way", {}};
  } else {
    const auto outcome = cycle::attempt(cycle::Refusal::kDamaged, [&] {
      command->reply =
          std::visit([&](const auto& request) { return answer(*command, request); }, command->request);
    });
    if (!outcome.done()) command->reply = error_of(outcome);
    if (next_) follow_parts();
  }
  done_.push_back(std::move(command));
}

// Inputs that came before the change is ready act before it: a push knows its body by the old numbers.
void TickSide::finish_changes() {
  while (changes_.ready()) {
    apply_inputs();
    auto finished = changes_.finish();
    if (!finished) continue;  // the thread is at its second half
    auto& [command, outcome, reply] = *finished;
    command->reply = outcome.done() ? std::move(reply) : Reply(error_of(outcome));
    follow_parts();
    const bool loaded = std::holds_alternative<protocol::LoadScene>(command->request);
    if (outcome.done() && (loaded || goes_back(command->request))) {
      time_went_back();
      holders_.clear();  // what they moved moves as the state says
      // It has undone these stops. The parts of another scene are others.
      if (!loaded)
        for (const auto part : stopped_meanwhile_) stop(part);
    }
    if (!changes_.under_way()) stopped_meanwhile_.clear();
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

// Scopes that change the bodies go through BodyChanges.
Reply TickSide::answer(Command&, const protocol::Reset& request) {
  simulation_.reset(request.scope);
  time_went_back();
  if (goes_back(request)) holders_.clear();
  return Ok{};
}

void TickSide::time_went_back() {
  for (auto& watch : watches_) watch.last_tick = simulation_.tick_count();
}

Reply TickSide::answer(Command& command, const protocol::SetBody& request) {
  const auto& model = simulation_.model();
  const auto body = model.find_body(request.body);
  if (!body.valid()) return error_of(cycle::unknown_body(model, request.body));
  std::optional<world::Pose> X_WB;
  if (const auto& p = request.pose; !p.empty())
    X_WB = world::Pose{Eigen::Vector3d(p.data()), Eigen::Quaterniond(p[3], p[4], p[5], p[6])};
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero(), w_WB = Eigen::Vector3d::Zero();
  if (!request.velocity.empty()) {
    v_WB = Eigen::Vector3d(request.velocity.data());
    w_WB = Eigen::Vector3d(request.velocity.data() + 3);
  }
  const auto outcome = simulation_.set_body(body, X_WB, v_WB, w_WB);
  if (!outcome.done()) return error_of(outcome);
  holders_.note_body(request.keeps_moving ? 0 : command.session, request.body);
  return Ok{};
}

Reply TickSide::answer(Command& command, const protocol::SetJoints& request) {
  const auto& model = simulation_.model();
  const std::string prefix = request.model.empty() ? "" : request.model + "/";
  std::vector<world::JointPlacement> to;
  std::vector<std::string> names, known;
  for (const auto& target : request.joints) {
    names.push_back(prefix + target.name);
    to.push_back({model.find_joint(names.back()), target.position, target.velocity});
    if (to.back().joint.valid()) continue;
    for (const auto& joint : model.joints)
      if (joint.name.starts_with(prefix)) known.push_back(joint.name.substr(prefix.size()));
    const bool no_model = known.empty() && !request.model.empty();
    return Error{ErrorCode::kUnknownName,
                 no_model ? "there is no model '" + request.model + "' with joints"
                          : config::unknown_name("joint", target.name, known),
                 {}};
  }
  const auto outcome = simulation_.set_joints(to);
  if (!outcome.done()) return error_of(outcome);
  holders_.note_joints(request.keeps_moving ? 0 : command.session, names);
  return Ok{};
}

Reply TickSide::answer(Command& command, const protocol::PullBody& request) {
  const auto& model = simulation_.model();
  const auto body = model.find_body(request.body);
  if (!body.valid()) return error_of(cycle::unknown_body(model, request.body));
  cycle::Pull pull{body,
                   model.bodies[body.index()].p_BC,
                   Eigen::Vector3d(request.target_m.data()),
                   request.max_force_n,
                   0,
                   command.session};
  if (!request.point_m.empty()) pull.p_B = Eigen::Vector3d(request.point_m.data());
  const auto tick_ns = model.tick_ns;
  if (request.duration_ns != 0)
    pull.until_tick = simulation_.tick_count() + (request.duration_ns + tick_ns - 1) / tick_ns;
  const auto outcome = simulation_.pull(pull);
  if (!outcome.done()) return error_of(outcome);
  return Ok{};
}

Reply TickSide::answer(Command& command, const protocol::ReleaseBody& request) {
  const auto body = simulation_.model().find_body(request.body);
  if (!body.valid()) return error_of(cycle::unknown_body(simulation_.model(), request.body));
  for (const auto& pull : simulation_.pulls())
    if (pull.body == body && pull.owner != command.session && pull.owner != 0)
      return Error{ErrorCode::kWrongState, "'" + request.body + "' is pulled by another session", {}};
  if (!simulation_.release(body))
    return Error{ErrorCode::kWrongState, "nobody pulls '" + request.body + "'", {}};
  return Ok{};
}

Reply TickSide::answer(Command&, const protocol::TakeSnapshot&) {
  const auto number = simulation_.take_snapshot();
  return protocol::SnapshotTaken{number, simulation_.tick_count(), simulation_.state_hash()};
}

Reply TickSide::answer(Command&, const protocol::RestoreSnapshot& request) {
  if (const auto outcome = simulation_.restore_snapshot(request.snapshot); !outcome.done())
    return error_of(outcome);
  time_went_back();
  holders_.clear();
  return Ok{};
}

cycle::BoundPart* TickSide::part_or_fail(Command& command) {
  if (const auto index = numbers_.find(command.part, command.generation)) return &simulation_.parts()[*index];
  command.reply = Error{ErrorCode::kUnknownName, "the part went with its model", {}};
  return nullptr;
}

Reply TickSide::answer(Command& command, const protocol::GetParameters&) {
  const auto* bound = part_or_fail(command);
  if (!bound) return command.reply;
  return protocol::ParameterList{bound->part->parameters()};
}

Reply TickSide::answer(Command& command, const protocol::SetParameter& request) {
  const auto* bound = part_or_fail(command);
  if (!bound) return command.reply;
  const auto outcome = simulation_.set_parameter(number_of(*bound), request.name, request.value);
  if (!outcome.done()) return error_of(outcome);
  return Ok{};
}

Reply TickSide::answer(Command& command, const protocol::ReadBlackboard& request) {
  const auto* bound = part_or_fail(command);
  if (!bound) return command.reply;
  const auto& part = *bound->part;
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
  const auto* bound = part_or_fail(command);
  if (!bound) return command.reply;
  const auto& boards = bound->part->description().blackboards;
  const auto board = std::ranges::find(boards, request.name, &protocol::Blackboard::name) - boards.begin();
  const auto outcome = simulation_.write_blackboard(number_of(*bound), static_cast<std::size_t>(board),
                                                    request.offset, request.data);
  if (!outcome.done()) return error_of(outcome);
  return Ok{};
}

// All pieces act as one write of the whole content, as each would have by itself.
Reply TickSide::answer(Command& command, const protocol::UnlockBlackboard& request) {
  const auto* bound = part_or_fail(command);
  if (!bound) return command.reply;
  const auto& part = *bound->part;
  const auto& boards = part.description().blackboards;
  const auto board = static_cast<std::size_t>(
      std::ranges::find(boards, request.name, &protocol::Blackboard::name) - boards.begin());
  const auto before = part.read_blackboard(board);
  std::vector<std::byte> content(before.begin(), before.end());
  for (const auto& piece : command.pieces) {
    if (!hwparts::write_into(content, piece.offset, piece.data))
      return Error{ErrorCode::kBadValue,
                   "'" + request.name + "': a piece begins beyond the content, at byte " +
                       std::to_string(piece.offset),
                   {}};
  }
  const auto outcome = simulation_.write_blackboard(number_of(*bound), board, 0, content);
  if (!outcome.done()) return error_of(outcome);
  return Ok{};
}

template <typename Other>
Reply TickSide::answer(Command&, const Other&) {
  return Error{ErrorCode::kInternal, "this request is no command", {}};
}

}  // namespace visum::gateway
