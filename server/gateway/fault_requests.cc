#include "server/gateway/fault_requests.h"

#include <vector>

#include "protocol/config/number_text.h"
#include "protocol/config/unknown_name.h"
#include "server/cycle/network_model.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

protocol::FaultKind describe(const hwparts::FaultInfo& info) {
  protocol::FaultKind kind{info.name, hwparts::name_of(info.target), info.effect, {}};
  for (const auto& number : info.numbers)
    if (number)
      kind.numbers.push_back({number->name, number->unit, number->minimum, number->maximum,
                              !number->usual.has_value(), number->usual.value_or(0.0)});
  return kind;
}

protocol::ActiveFault describe(const hwparts::ActiveFault& active, const std::string& part) {
  const auto& info = hwparts::fault_info(active.fault.kind);
  protocol::ActiveFault fault{part, info.name, {}, active.until_tick};
  for (std::size_t i = 0; i < info.numbers.size(); ++i)
    if (info.numbers[i]) fault.numbers.push_back({info.numbers[i]->name, active.fault.numbers[i]});
  return fault;
}

}  // namespace

std::optional<std::string> FaultRequests::refuse(std::uint32_t part, const hwparts::Fault& fault) const {
  const auto& name = world_.part_name(part);
  const bool of_bus = hwparts::fault_info(fault.kind).target == hwparts::FaultTarget::kBus;
  if (auto reason = world_.parts[part]->refuse_fault(fault)) return reason;
  const auto room =
      cycle::NetworkModel::has_room_for(fault, world_.parts[part]->description(), world_.tick_ns);
  if (!room.done()) return room.text();
  if (of_bus && !buses_.has(name)) return "'" + name + "' is on no field bus (visumd --bus)";
  return std::nullopt;
}

void FaultRequests::handle(const Call& call, const protocol::InjectFault& request) {
  constexpr std::int64_t kLongest_ns = 1'000'000'000'000'000;
  const auto part = part_or_fail(call, world_, request.part);
  if (!part) return;
  hwparts::NamedNumbers numbers;
  for (const auto& [name, value] : request.numbers) numbers.emplace_back(name, value);
  std::string why;
  const auto fault = hwparts::make_fault(request.kind, numbers, why);
  if (!fault)
    return call.fail(hwparts::find_fault_kind(request.kind) ? ErrorCode::kBadValue : ErrorCode::kUnknownName,
                     why);
  if (request.duration_ns < 0 || request.duration_ns > kLongest_ns)
    return call.fail(ErrorCode::kBadValue, "duration_ns must be within 0 and 1e15");
  if (auto reason = refuse(*part, *fault)) return call.fail(ErrorCode::kBadValue, *reason);
  auto* input = limiter_.blank_or_fail(call);
  if (!input) return;
  input->kind = Input::Kind::kFault;
  input->part = *part;
  input->generation = world_.generation(*part);
  input->epoch = order_of(call);
  input->fault = *fault;
  input->duration_ticks = world_.to_ticks(request.duration_ns);
  mailbox_.send(input);
  std::string text = request.kind;
  for (const auto& [name, value] : request.numbers) text += " " + name + "=" + config::number_text(value);
  call.clients.tell({"fault", text, request.part, call.clients.known_era(), call.now.tick,
                     protocol::EventLevel::kWarning, call.session.client_name()});
  call.reply(protocol::Ok{});
}

void FaultRequests::handle(const Call& call, const protocol::ClearFault& request) {
  const auto part = part_or_fail(call, world_, request.part);
  if (!part) return;
  const auto* kind = hwparts::find_fault_kind(request.kind);
  if (!kind && !request.kind.empty())
    return call.fail(ErrorCode::kUnknownName, hwparts::unknown_fault(request.kind));
  auto* input = limiter_.blank_or_fail(call);
  if (!input) return;
  input->kind = Input::Kind::kClearFault;
  input->part = *part;
  input->generation = world_.generation(*part);
  input->epoch = order_of(call);
  input->fault_kind.reset();
  input->fault_drive.reset();
  if (kind) input->fault_kind = kind->kind;
  if (request.joint != 0) input->fault_drive = request.joint - 1;
  mailbox_.send(input);
  call.clients.tell({"fault_cleared", request.kind.empty() ? "all faults" : request.kind, request.part,
                     call.clients.known_era(), call.now.tick, protocol::EventLevel::kInfo,
                     call.session.client_name()});
  call.reply(protocol::Ok{});
}

void FaultRequests::handle(const Call& call, const protocol::ListFaults& request) {
  std::optional<std::uint32_t> only;
  if (!request.part.empty()) {
    only = part_or_fail(call, world_, request.part);
    if (!only) return;
  }
  const auto concerned = [&](std::uint32_t part) { return !only || *only == part; };
  protocol::FaultList list;
  for (const auto& info : hwparts::fault_kinds()) {
    bool known = false;
    for (std::uint32_t part = 0; part < world_.parts.size(); ++part)
      known = known || (concerned(part) && world_.parts[part]->has(info.target));
    if (known) list.kinds.push_back(describe(info));
  }
  for (const auto& active : call.now.faults)
    if (concerned(active.part)) list.active.push_back(describe(active, world_.part_name(active.part)));
  call.reply(list);
}

}  // namespace visum::gateway
