#include "server/gateway/part_settings.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "protocol/config/unknown_name.h"
#include "server/gateway/access.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& list) {
  std::vector<std::string> names;
  for (const auto& entry : list) names.push_back(entry.name);
  return names;
}

}  // namespace

void PartSettings::handle(const Call& call, const protocol::GetParameters& request) {
  if (const auto part = part_or_fail(call, world_, request.part)) commands_.send(call, request, *part);
}

void PartSettings::handle(const Call& call, const protocol::SetParameter& request) {
  const auto part = part_or_fail(call, world_, request.part);
  if (!part) return;
  // An observer may pull an emergency stop, and an admin may set everything: neither needs the lease.
  const bool needs_lease =
      call.session.role() < protocol::Role::kAdmin && role_needed(request) > protocol::Role::kObserver;
  if (needs_lease && !parts_.lease_or_fail(call, *part)) return;
  if (const auto* number = std::get_if<double>(&request.value); number && !std::isfinite(*number))
    return call.fail(ErrorCode::kBadValue, "'" + request.name + "' must be a finite number");
  const auto known = names_of(world_.parts[*part]->description().parameters);
  if (std::ranges::find(known, request.name) == known.end())
    return call.fail(ErrorCode::kUnknownName, config::unknown_name("parameter", request.name, known));
  if (is_emergency_stop(request)) return commands_.stop(call, *part);
  commands_.send(call, request, *part);
}

void PartSettings::press_early(const protocol::SetParameter& stop) {
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part) {
    const auto& description = world_.parts[part]->description();
    const auto& known = description.parameters;
    if (description.name == stop.part &&
        std::ranges::find(known, stop.name, &protocol::Parameter::name) != known.end())
      commands_.press(part);
  }
}

bool PartSettings::blackboard_or_fail(const Call& call, std::uint32_t part, const std::string& name,
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

void PartSettings::handle(const Call& call, const protocol::ReadBlackboard& request) {
  const auto part = part_or_fail(call, world_, request.part);
  if (part && blackboard_or_fail(call, *part, request.name, false)) commands_.send(call, request, *part);
}

std::optional<std::uint32_t> PartSettings::writable_or_fail(const Call& call, const std::string& part,
                                                            const std::string& name) const {
  const auto found = part_or_fail(call, world_, part);
  if (!found || !blackboard_or_fail(call, *found, name, true) || !parts_.lease_or_fail(call, *found))
    return {};
  return found;
}

void PartSettings::handle(const Call& call, const protocol::WriteBlackboard& request) {
  const auto part = writable_or_fail(call, request.part, request.name);
  if (!part) return;
  BlackboardLocks::Refusal refusal;
  if (!locks_.keep(call.session.id(), request, call.now, refusal))
    return commands_.send(call, request, *part);
  if (refusal) return call.fail(refusal->first, refusal->second);
  call.reply(protocol::Ok{});
}

void PartSettings::handle(const Call& call, const protocol::LockBlackboard& request) {
  if (!writable_or_fail(call, request.part, request.name)) return;
  const auto ticks = world_.to_ticks(request.timeout_ns);
  if (const auto refusal = locks_.lock(call.session.id(), request, ticks, call.now))
    return call.fail(refusal->first, refusal->second);
  call.reply(protocol::Ok{});
}

void PartSettings::handle(const Call& call, const protocol::UnlockBlackboard& request) {
  const auto part = writable_or_fail(call, request.part, request.name);
  if (!part) return;
  BlackboardLocks::Refusal refusal;
  auto pieces = locks_.unlock(call.session.id(), request, call.now, refusal);
  if (refusal) return call.fail(refusal->first, refusal->second);
  if (pieces.empty()) return call.reply(protocol::Ok{});
  commands_.send(call, request, *part, std::move(pieces));
}

}  // namespace visum::gateway
