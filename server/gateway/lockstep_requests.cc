// The lockstep: who steps with the world, how far each lets it run, and what happens to who does not come.
#include <algorithm>
#include <string>

#include "server/gateway/gateway.h"

namespace visum::gateway {

using protocol::ErrorCode;
using protocol::OnTimeout;

namespace {

constexpr std::int64_t kMostTicks = 1'000'000'000;
constexpr std::size_t kMostStreams = 64, kLongestNote = 200;
constexpr std::uint32_t kLastPort = 65535;
constexpr std::uint32_t kGradeGate = 1, kGradeShim = 2, kGradeStep = 4;

// Why an Advance cannot be; empty: it can.
std::string fault_of(const protocol::Advance& request, bool lockstep) {
  const int least = request.follow_buses ? 0 : 1;
  if (request.ticks < least || request.ticks > kMostTicks)
    return "ticks must be within " + std::to_string(least) + " and " + std::to_string(kMostTicks);
  if (request.follow_buses && !lockstep) return "follow_buses is for the clock lockstep";
  if (request.streams.size() > kMostStreams) return "more than " + std::to_string(kMostStreams) + " streams";
  for (const auto& stream : request.streams)
    if (stream.port < 1 || stream.port > kLastPort)
      return "the port of a stream must be within 1 and " + std::to_string(kLastPort);
  return {};
}

}  // namespace

void Gateway::handle(const Call& call, const protocol::Join& request) {
  if (members_.find(call.session.id()))
    return call.fail(ErrorCode::kWrongState, "this session has joined already");
  if (request.timeout_ns < 0) return call.fail(ErrorCode::kBadValue, "timeout_ns must not be negative");
  const auto grade = request.grade == 0 ? kGradeStep : request.grade;
  if (grade != kGradeGate && grade != kGradeShim && grade != kGradeStep)
    return call.fail(ErrorCode::kBadValue, "grade must be 1 (gate), 2 (time shim) or 4 (steps of its own)");
  if ((grade == kGradeGate) != request.gate.has_value())
    return call.fail(ErrorCode::kBadValue, "grade 1 needs a gate, and no other has one");
  if (auto why = request.gate ? fault_of_gate(*request.gate) : std::string(); !why.empty())
    return call.fail(ErrorCode::kBadValue, why);
  std::vector<std::uint32_t> parts;
  for (const auto& name : request.parts) {
    const auto part = part_or_fail(call, name);
    if (!part) return;
    parts.push_back(*part);
  }
  const auto& now = *now_;
  const auto timeout =
      request.timeout_ns > 0 ? std::chrono::nanoseconds(request.timeout_ns) : world_.lockstep_timeout;
  auto& member = members_.join(call.session.id(), call.session.client_name(), now.tick, timeout);
  member.grade = grade;
  member.on_timeout = request.on_timeout;
  member.own_timeout = request.timeout_ns > 0;
  // From now on it is waited for.
  const bool waited_for = member.own_timeout || grade != kGradeStep;
  if (waited_for && world_.clock == scene::ClockKind::kLockstep) start_asked_ = true;
  member.parts = std::move(parts);
  if (request.gate) open_gate(member, *request.gate);
  call.reply(protocol::Advanced{now.tick, now.sim_time_ns, now.era});
}

void Gateway::handle(const Call& call, const protocol::Advance& request) {
  auto* member = members_.find(call.session.id());
  if (!member) return call.fail(ErrorCode::kWrongState, "Advance needs Join first");
  if (member->advance) return call.fail(ErrorCode::kWrongState, "the previous Advance is not yet answered");
  const auto why = fault_of(request, world_.clock == scene::ClockKind::kLockstep);
  if (!why.empty()) return call.fail(ErrorCode::kBadValue, why);
  const auto& now = *now_;
  if (!now.fault.empty()) return call.fail(ErrorCode::kFrozen, now.fault);
  // Who comes later than a whole period in realtime or free starts anew from now: no burst of answers.
  if (now.tick - member->granted_tick > request.ticks) member->granted_tick = now.tick;
  member->granted_tick += request.ticks;
  member->waited_since.reset();
  member->advance = call.id;
  member->note.clear();
  if (request.follow_buses) member->follows = {request.bus_said, request.streams, false};
  call.client.waiting = true;
  start_asked_ = true;
  mailbox_.wake();
  answer(*member, now);
  if (member->advance) call.session.hold();  // what was answered to writes before it leaves with its answer
}

void Gateway::handle(const Call& call, const protocol::Leave&) {
  if (!members_.find(call.session.id()))
    return call.fail(ErrorCode::kWrongState, "this session has not joined");
  leave(call.session.id());
  call.reply(protocol::Ok{});
}

void Gateway::handle(const Call& call, const protocol::Note& request) {
  auto* member = members_.find(call.session.id());
  if (!member) return call.fail(ErrorCode::kWrongState, "Note needs Join first");
  if (request.text.size() > kLongestNote)
    return call.fail(ErrorCode::kBadValue, "a note has at most " + std::to_string(kLongestNote) + " bytes");
  member->note = request.text;
  call.reply(protocol::Ok{});
}

// What a member has heard of its program's connections, against what has been said by now.
bool Gateway::was_told_more(const Follows& follows) {
  if (bus_door_.said() > follows.bus_said) return true;
  auto streams = follows.streams;
  for (auto& stream : streams) stream.written = 0;  // who is gone says nothing more
  bus_door_.fill_in(streams);
  for (std::size_t i = 0; i < streams.size(); ++i)
    if (streams[i].written > follows.streams[i].heard) return true;
  return false;
}

bool Gateway::follow_buses(std::int64_t tick) {
  bool any = false;
  for (auto& member : members_.all()) {
    if (member.bus_gate) follow_gate(member);
    if (!member.advance || !member.follows) continue;
    auto& follows = *member.follows;
    if (!follows.settled) {
      bus_door_.settle(follows.streams);
      follows.settled = true;
      any = true;
      if (member.bus_gate) follow_gate(member);
    }
    if (tick < member.granted_tick && !member.bus_gate && was_told_more(follows)) {
      member.granted_tick = tick;
      any = true;
    }
  }
  return any;
}

void Gateway::answer_advances(const Published& now) {
  for (auto& member : members_.all()) answer(member, now);
}

// Answers a member that waits for a tick that has come, or never will.
void Gateway::answer(Member& member, const Published& now) {
  if (!member.advance) return;
  if (now.fault.empty() && (now.tick < member.granted_tick || (member.follows && !member.follows->settled)))
    return;
  auto& client = clients_.at(member.session);
  if (!now.fault.empty())
    client.session->send(*member.advance, protocol::Error{ErrorCode::kFrozen, now.fault, {}});
  else if (*member.advance != 0)
    client.session->send(*member.advance, advanced(member, now));
  member.advance.reset();
  member.follows.reset();
  client.waiting = false;
}

protocol::Advanced Gateway::advanced(const Member& member, const Published& now) {
  protocol::Advanced reply{now.tick, now.sim_time_ns, now.era};
  if (!member.follows) return reply;
  reply.bus_said = bus_door_.said();
  reply.streams = member.follows->streams;
  for (auto& stream : reply.streams) std::swap(stream.written, stream.heard);
  bus_door_.fill_in(reply.streams);
  return reply;
}

void Gateway::check_timeouts(std::int64_t tick) {
  const auto* late = members_.waited_too_long(tick, clock_());
  if (!late) return;
  const auto session = late->session;
  const auto on_timeout = late->on_timeout;
  const std::string text = "'" + late->client + "' held the lockstep at tick " + std::to_string(tick) +
                           " for longer than its time-out";
  if (on_timeout == OnTimeout::kEnd) end_advances(tick, text);
  if (on_timeout == OnTimeout::kFree)
    dropped_.insert(session);
  else
    lose_parts_of(session, text);
  leave(session);
  broadcast({"lockstep_timeout", text, {}, era_, tick});
}

void Gateway::end_advances(std::int64_t tick, const std::string& why) {
  for (auto& member : members_.all()) {
    if (!member.advance) continue;
    auto& client = clients_.at(member.session);
    client.session->send(*member.advance, protocol::Error{ErrorCode::kTimeout, why, {}});
    client.waiting = false;
    member.advance.reset();
    member.follows.reset();
    member.granted_tick = tick;
    member.waited_since.reset();
  }
}

}  // namespace visum::gateway
