// What is asked of parts: ports, leases, parameters, blackboards.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"
#include "server/gateway/gateway.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

std::string in_words(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", number);
  return text;
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
  std::vector<std::string> names;
  for (const auto& entry : list) names.push_back(entry.name);
  return names;
}

}  // namespace

std::optional<std::uint32_t> Gateway::part_or_fail(const Call& call, const std::string& name) const {
  std::vector<std::string> known;
  for (std::uint32_t i = 0; i < world_.parts.size(); ++i) {
    known.push_back(world_.parts[i]->description().name);
    if (known.back() == name) return i;
  }
  call.fail(ErrorCode::kUnknownName, config::unknown_name("part", name, known));
  return {};
}

bool Gateway::lease_or_fail(const Call& call, std::uint32_t part) const {
  if (leases_.held_by(part, call.session.id())) return true;
  const auto& lease = leases_.of(part);
  const auto& name = world_.parts[part]->description().name;
  call.fail(ErrorCode::kNoLease,
            "the part '" + name + "' is " +
                (lease.session == 0 ? "leased by nobody" : "leased by '" + lease.owner + "'") +
                "; acquire its lease first",
            lease.owner);
  return false;
}

protocol::PartList Gateway::part_list() const {
  protocol::PartList list;
  for (std::uint32_t i = 0; i < world_.parts.size(); ++i) {
    const auto& description = world_.parts[i]->description();
    list.parts.push_back({description.name, description.kind, leases_.of(i).owner});
  }
  return list;
}

void Gateway::handle(const Call& call, const protocol::ListParts&) {
  call.reply(part_list());
}

void Gateway::handle(const Call& call, const protocol::DescribePart& request) {
  if (const auto part = part_or_fail(call, request.part))
    call.reply(protocol::PartDescriptionReply{world_.parts[*part]->description(), leases_.of(*part).owner});
}

void Gateway::handle(const Call& call, const protocol::AcquireLease& request) {
  const auto part = part_or_fail(call, request.part);
  if (!part) return;
  if (request.deadline_ns < 0) return call.fail(ErrorCode::kBadValue, "deadline_ns must not be negative");
  const auto& lease = leases_.of(*part);
  const bool others = lease.session != 0 && lease.session != call.session.id();
  if (others) {
    if (!request.take || lease.session == kAgentsSession)
      return call.fail(ErrorCode::kLeased,
                       "the part '" + request.part + "' is leased by '" + lease.owner + "'", lease.owner);
    if (call.session.role() < protocol::Role::kAdmin)
      return call.fail(ErrorCode::kForbidden, "only the role admin takes a lease from '" + lease.owner + "'",
                       lease.owner);
  }
  if (!others && !late_writes_sent_or_fail(call, *part)) return;
  auto* input = input_or_fail(call);
  if (!input) return;
  if (others) {
    spdlog::warn("'{}' at {} takes the lease of '{}' from '{}'", call.session.client_name(),
                 call.session.peer(), request.part, lease.owner);
    lose_lease(*part, "taken by '" + call.session.client_name() + "'");
  }
  const auto epoch = leases_.grant(*part, call.session.id(), call.session.client_name());
  input->kind = Input::Kind::kLeaseGranted;
  input->part = *part;
  input->epoch = epoch;
  input->deadline_ticks = to_ticks(request.deadline_ns);
  mailbox_.send(input);
  call.reply(protocol::LeaseGrant{request.part, epoch});
}

void Gateway::handle(const Call& call, const protocol::ReleaseLease& request) {
  const auto part = part_or_fail(call, request.part);
  if (!part || !lease_or_fail(call, *part)) return;
  send_late_writes(*part);  // those that find no room follow the release
  // However much was sent: a release follows a grant, as a loss does.
  auto* input = blank_input_or_fail(call, true);
  if (!input) return;
  input->kind = Input::Kind::kLeaseReleased;
  input->part = *part;
  input->epoch = leases_.of(*part).epoch;
  mailbox_.send(input);
  leases_.free(*part);
  call.reply(protocol::Ok{});
}

// Why these values cannot be written; the first bad one by name and range. `wanted`: all inputs with them.
std::optional<std::string> Gateway::why_not(std::uint32_t part, const protocol::Write& request,
                                            std::vector<double>& wanted) const {
  const auto& ports = world_.parts[part]->description().controller_inputs;
  if (request.values.empty()) return "no values";
  if (request.first_port >= ports.size() || request.values.size() > ports.size() - request.first_port)
    return "ports " + std::to_string(request.first_port) + " to " +
           std::to_string(request.first_port + request.values.size() - 1) + " of " +
           std::to_string(ports.size());
  wanted = latched_[part];
  for (std::size_t i = 0; i < request.values.size(); ++i) {
    const auto& port = ports[request.first_port + i];
    const double value = request.values[i];
    if (!std::isfinite(value)) return "'" + port.name + "' must be a finite number";
    if (value < port.minimum || value > port.maximum)
      return "'" + port.name + "' must be within " + in_words(port.minimum) + " and " +
             in_words(port.maximum) + ", is " + in_words(value);
    wanted[request.first_port + i] = value;
  }
  return world_.parts[part]->refuse(wanted);
}

void Gateway::handle(const Call& call, const protocol::Write& request) {
  const auto part = part_or_fail(call, request.part);
  if (!part || !lease_or_fail(call, *part)) return;
  std::vector<double> wanted;
  if (auto reason = why_not(*part, request, wanted)) return call.fail(ErrorCode::kBadValue, *reason);
  if (auto reason = world_.parts[*part]->refuse_now(latched_[*part], wanted))
    return call.fail(ErrorCode::kWrongState, *reason);
  if (!leases_.is_new(*part, request.sequence))
    return call.fail(ErrorCode::kStale, "sequence " + std::to_string(request.sequence) +
                                            " is not newer than " +
                                            std::to_string(leases_.of(*part).sequence));
  Input* input = nullptr;
  if (!has_sent_enough(call.client) && send_late_writes(*part))  // in their order
    input = mailbox_.blank_input();
  leases_.take_sequence(*part, request.sequence);
  std::ranges::copy(request.values, latched_[*part].begin() + request.first_port);
  if (input) {
    ++call.client.inputs_at_tick;
    send_write(*part, request.first_port,
               static_cast<std::uint32_t>(request.first_port + request.values.size()), input);
  } else {
    late_.add(*part, request.first_port, request.values.size());
  }
  call.reply(protocol::Ok{});
}

// The values that are latched for these ports.
void Gateway::send_write(std::uint32_t part, std::uint32_t first_port, std::uint32_t end_port, Input* input) {
  input->kind = Input::Kind::kWrite;
  input->part = part;
  input->epoch = leases_.of(part).epoch;
  input->first_port = first_port;
  input->values.assign(latched_[part].begin() + first_port, latched_[part].begin() + end_port);
  mailbox_.send(input);
}

void Gateway::send_late_writes() {
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) {
    if (!late_.has(part)) continue;
    const auto holder = clients_.find(leases_.of(part).session);  // none: it has released the part
    if (holder == clients_.end() || !has_sent_enough(holder->second)) send_late_writes(part);
  }
}

bool Gateway::complete_writes() {
  if (late_.empty()) return false;
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) send_late_writes(part);
  return true;
}

bool Gateway::send_late_writes(std::uint32_t part) {
  while (late_.has(part)) {
    auto* input = mailbox_.blank_input();
    if (!input) return false;
    const auto [first_port, end_port] = late_.take_run(part);
    send_write(part, first_port, end_port, input);
  }
  return true;
}

bool Gateway::late_writes_sent_or_fail(const Call& call, std::uint32_t part) {
  if (send_late_writes(part)) return true;
  call.fail(ErrorCode::kBusy, kTooManyInputs);
  return false;
}

void Gateway::end_late_writes(std::uint32_t part) {
  send_late_writes(part);
  late_.drop(part);
}

void Gateway::handle(const Call& call, const protocol::Read& request) {
  if (const auto part = part_or_fail(call, request.part)) call.reply(part_sample(*part, *now_));
}

protocol::PartSample Gateway::part_sample(std::uint32_t part, const Published& now) const {
  const auto& values = now.parts[part];
  return {world_.parts[part]->description().name,
          now.tick,
          now.sim_time_ns,
          now.era,
          values.controller_inputs,
          values.sensor_outputs,
          0};
}

void Gateway::handle(const Call& call, const protocol::Subscribe& request) {
  if (const auto part = part_or_fail(call, request.part)) subscribe(call, *part, request.every_n_ticks);
}

void Gateway::handle(const Call& call, const protocol::Unsubscribe& request) {
  if (const auto part = part_or_fail(call, request.part)) unsubscribe(call, *part);
}

void Gateway::handle(const Call& call, const protocol::GetParameters& request) {
  if (const auto part = part_or_fail(call, request.part)) send_command(call, request, *part);
}

void Gateway::handle(const Call& call, const protocol::SetParameter& request) {
  const auto part = part_or_fail(call, request.part);
  if (!part) return;
  // What anybody may do, an emergency stop, waits for nobody's lease.
  const bool needs_lease =
      call.session.role() < protocol::Role::kAdmin && role_needed(request) > protocol::Role::kObserver;
  if (needs_lease && !lease_or_fail(call, *part)) return;
  if (const auto* number = std::get_if<double>(&request.value); number && !std::isfinite(*number))
    return call.fail(ErrorCode::kBadValue, "'" + request.name + "' must be a finite number");
  const auto known = names_of(world_.parts[*part]->description().parameters);
  if (std::ranges::find(known, request.name) == known.end())
    return call.fail(ErrorCode::kUnknownName, config::unknown_name("parameter", request.name, known));
  send_command(call, request, *part);
}

bool Gateway::blackboard_or_fail(const Call& call, std::uint32_t part, const std::string& name,
                                 bool to_write) const {
  const auto& boards = world_.parts[part]->description().blackboards;
  const auto board = std::ranges::find(boards, name, &protocol::Blackboard::name);
  if (board == boards.end()) {
    call.fail(ErrorCode::kUnknownName, config::unknown_name("blackboard", name, names_of(boards)));
    return false;
  }
  if (to_write && !board->writable) {
    call.fail(ErrorCode::kForbidden, "the blackboard '" + name + "' is read-only");
    return false;
  }
  return true;
}

void Gateway::handle(const Call& call, const protocol::ReadBlackboard& request) {
  const auto part = part_or_fail(call, request.part);
  if (part && blackboard_or_fail(call, *part, request.name, false)) send_command(call, request, *part);
}

void Gateway::handle(const Call& call, const protocol::WriteBlackboard& request) {
  const auto part = part_or_fail(call, request.part);
  if (part && blackboard_or_fail(call, *part, request.name, true) && lease_or_fail(call, *part))
    send_command(call, request, *part);
}

}  // namespace visum::gateway
