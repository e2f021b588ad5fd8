#include "server/gateway/lockstep.h"

#include <algorithm>
#include <utility>
#include <vector>

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
  if (request.members > 0 && (!lockstep || request.follow_buses))
    return "members is for the clock lockstep, and not for an Advance with follow_buses";
  if (request.follow_buses && !lockstep) return "follow_buses is for the clock lockstep";
  if (request.streams.size() > kMostStreams) return "more than " + std::to_string(kMostStreams) + " streams";
  for (const auto& stream : request.streams)
    if (stream.port < 1 || stream.port > kLastPort)
      return "the port of a stream must be within 1 and " + std::to_string(kLastPort);
  return {};
}

}  // namespace

Lockstep::Lockstep(const StaticWorld& world, Mailbox& mailbox, Clients& clients, Parts& parts,
                   bus::BusDoor& buses)
    : world_(world),
      mailbox_(mailbox),
      clients_(clients),
      parts_(parts),
      buses_(buses),
      gates_(world, members_, buses) {}

void Lockstep::handle(const Call& call, const protocol::Join& request) {
  if (members_.find(call.session.id()))
    return call.fail(ErrorCode::kWrongState, "this session has joined already");
  if (request.timeout_ns < 0) return call.fail(ErrorCode::kBadValue, "timeout_ns must not be negative");
  const auto grade = request.grade == 0 ? kGradeStep : request.grade;
  if (grade != kGradeGate && grade != kGradeShim && grade != kGradeStep)
    return call.fail(ErrorCode::kBadValue, "grade must be 1 (gate), 2 (time shim) or 4 (steps of its own)");
  if ((grade == kGradeGate) != request.gate.has_value())
    return call.fail(ErrorCode::kBadValue, "grade 1 needs a gate, and no other has one");
  if (auto why = request.gate ? gates_.refuse(*request.gate) : std::string(); !why.empty())
    return call.fail(ErrorCode::kBadValue, why);
  std::vector<std::uint32_t> parts;
  for (const auto& name : request.parts) {
    const auto part = part_or_fail(call, world_, name);
    if (!part) return;
    parts.push_back(*part);
  }
  const auto& now = call.now;
  const auto timeout =
      request.timeout_ns > 0 ? std::chrono::nanoseconds(request.timeout_ns) : world_.lockstep_timeout;
  auto& member = members_.join(call.session.id(), call.session.client_name(), now.tick, timeout);
  member.grade = grade;
  member.on_timeout = request.on_timeout;
  member.own_timeout = request.timeout_ns > 0;
  // The world waits for these members from now on, so time has to start.
  const bool waited_for = member.own_timeout || grade != kGradeStep;
  if (waited_for && world_.clock == scene::ClockKind::kLockstep) start_asked_ = true;
  member.parts = std::move(parts);
  if (request.gate) gates_.open(member, *request.gate);
  call.reply(protocol::Advanced{now.tick, now.sim_time_ns, now.era});
}

void Lockstep::handle(const Call& call, const protocol::Advance& request) {
  auto* member = members_.find(call.session.id());
  if (!member) return call.fail(ErrorCode::kWrongState, "Advance needs Join first");
  if (member->advance) return call.fail(ErrorCode::kWrongState, "the previous Advance is not yet answered");
  const auto why = fault_of(request, world_.clock == scene::ClockKind::kLockstep);
  if (!why.empty()) return call.fail(ErrorCode::kBadValue, why);
  const auto& now = call.now;
  if (!now.fault.empty()) return call.fail(ErrorCode::kFrozen, now.fault);
  // Realtime and free: a member that is late by more than a period starts anew from now. Otherwise it would
  // get a burst of answers.
  if (now.tick - member->granted_tick > request.ticks) member->granted_tick = now.tick;
  if (request.members > 0)
    member->after = {request.ticks, request.members};
  else
    member->granted_tick += request.ticks;
  member->waited_since.reset();
  member->advance = call.id;
  member->answer_may_wait = request.answer_may_wait;
  member->note.clear();
  if (request.follow_buses) member->follows = {request.bus_said, request.streams, false};
  call.client.waiting = true;
  start_asked_ = true;
  mailbox_.wake();
  answer(*member, now);
  // Replies to the writes before it may leave together with its own. In real time that would delay them.
  if (member->advance && world_.clock == scene::ClockKind::kLockstep) call.session.hold_back(true);
}

void Lockstep::handle(const Call& call, const protocol::Leave&) {
  if (!members_.find(call.session.id()))
    return call.fail(ErrorCode::kWrongState, "this session has not joined");
  leave(call.session.id(), call.now);
  call.reply(protocol::Ok{});
}

void Lockstep::handle(const Call& call, const protocol::Note& request) {
  auto* member = members_.find(call.session.id());
  if (!member) return call.fail(ErrorCode::kWrongState, "Note needs Join first");
  if (request.text.size() > kLongestNote)
    return call.fail(ErrorCode::kBadValue, "a note has at most " + std::to_string(kLongestNote) + " bytes");
  member->note = request.text;
  call.reply(protocol::Ok{});
}

bool Lockstep::was_told_more(const Follows& follows) {
  if (buses_.said() > follows.bus_said) return true;
  auto streams = follows.streams;
  for (auto& stream : streams) stream.written = 0;  // a connection that is gone says nothing more
  buses_.fill_in(streams);
  for (std::size_t i = 0; i < streams.size(); ++i)
    if (streams[i].written > follows.streams[i].heard) return true;
  return false;
}

bool Lockstep::waits_for_tick(const protocol::Session& session, const protocol::Request& request) {
  return members_.is_member(session.id()) || gates_.gate_of(session) ||
         std::holds_alternative<protocol::Join>(request) ||
         std::holds_alternative<protocol::Advance>(request) ||
         std::holds_alternative<protocol::Leave>(request) || std::holds_alternative<protocol::Note>(request);
}

bool Lockstep::follow_members(std::int64_t tick) {
  bool any = false;
  for (auto& member : members_.all()) {
    if (!member.after || members_.others_hold(member, tick)) continue;
    if (member.after->members == members_.all().size())
      member.granted_tick += member.after->ticks;
    else
      any = true;
    member.after.reset();
  }
  return any;
}

bool Lockstep::follow_buses(std::int64_t tick) {
  bool any = false;
  for (auto& member : members_.all()) {
    gates_.follow_bus(member);
    if (!member.advance || !member.follows) continue;
    auto& follows = *member.follows;
    if (!follows.settled) {
      buses_.settle(follows.streams);
      follows.settled = true;
      any = true;
      gates_.follow_bus(member);
    }
    if (tick < member.granted_tick && !member.bus_gate && was_told_more(follows)) {
      member.granted_tick = tick;
      any = true;
    }
  }
  return any;
}

void Lockstep::answer_advances(const Published& now) {
  for (auto& member : members_.all()) answer(member, now);
}

void Lockstep::answer(Member& member, const Published& now) {
  if (!member.advance) return;
  const bool waits = now.tick < member.granted_tick || member.after;
  if (now.fault.empty() && (waits || (member.follows && !member.follows->settled))) return;
  auto& client = clients_.at(member.session);
  if (!now.fault.empty())
    client.session->send(*member.advance, protocol::Error{ErrorCode::kFrozen, now.fault, {}});
  else if (*member.advance != 0)
    client.session->send(*member.advance, advanced(member, now));
  client.session->hold_back(member.answer_may_wait && now.fault.empty());
  member.advance.reset();
  member.follows.reset();
  member.after.reset();
  client.waiting = false;
}

protocol::Advanced Lockstep::advanced(const Member& member, const Published& now) {
  protocol::Advanced reply{now.tick, now.sim_time_ns, now.era};
  if (!member.follows) return reply;
  reply.bus_said = buses_.said();
  reply.streams = member.follows->streams;
  for (auto& stream : reply.streams) std::swap(stream.written, stream.heard);
  buses_.fill_in(reply.streams);
  return reply;
}

void Lockstep::check_timeouts(std::int64_t tick, const Published& now) {
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
    parts_.lose_all_of(session, parts_commanded_by(session), text, now);
  leave(session, now);
  clients_.broadcast({"lockstep_timeout", text, {}, clients_.known_era(), tick});
}

void Lockstep::end_advances(std::int64_t tick, const std::string& why) {
  for (auto& member : members_.all()) {
    if (!member.advance) continue;
    auto& client = clients_.at(member.session);
    client.session->send(*member.advance, protocol::Error{ErrorCode::kTimeout, why, {}});
    client.session->hold_back(false);
    client.waiting = false;
    member.advance.reset();
    member.follows.reset();
    member.after.reset();
    member.granted_tick = tick;
    member.waited_since.reset();
  }
}

void Lockstep::leave(std::uint64_t session, const Published& now) {
  const auto* member = members_.find(session);
  if (!member) return;
  gates_.close(*member);
  for (auto& [id, client] : clients_.all())
    if (client.step_until && gates_.gate_of(*client.session) == member) client.step_until = now.tick;
  members_.leave(session);
}

void Lockstep::forget_parts(std::span<const std::uint32_t> gone) {
  for (auto& member : members_.all())
    std::erase_if(member.parts,
                  [&](std::uint32_t part) { return std::ranges::find(gone, part) != gone.end(); });
}

std::span<const std::uint32_t> Lockstep::parts_commanded_by(std::uint64_t session) const {
  for (const auto& member : members_.all())
    if (member.session == session) return member.parts;
  return {};
}

void Lockstep::remove(std::uint64_t session, const Published& now) {
  leave(session, now);
  dropped_.erase(session);
}

std::optional<std::int64_t> Lockstep::hold(const protocol::Session& session, const protocol::Request& request,
                                           const Published& now) {
  auto* member = gates_.gate_of(session);
  if (!member || !now.fault.empty() || !member->gate->ends_cycle(request)) return std::nullopt;
  member->granted_tick = now.tick + member->gate->period_ticks();
  member->waited_since.reset();
  start_asked_ = true;
  mailbox_.wake();
  return member->granted_tick;
}

void Lockstep::begin_cycle_with(const protocol::Session& session, const protocol::Request& request) {
  if (auto* member = gates_.gate_of(session)) member->gate->ends_cycle(request);
}

void Lockstep::begin_era(const Published& now) {
  members_.rebase(now.tick);
  for (auto& member : members_.all())
    if (member.gate) member.gate->restart();
}

void Lockstep::describe(protocol::ServerStatus& status) const {
  for (const auto& member : members_.all()) {
    const auto waited = member.waited_since ? clock_() - *member.waited_since : Member::Clock::duration{};
    status.lockstep.push_back({member.client, member.granted_tick, std::chrono::nanoseconds(waited).count(),
                               member.grade, member.note});
  }
  for (const auto& [id, client] : clients_.all()) {
    const auto& name = client.session->client_name();
    if (client.session->role() >= protocol::Role::kController && !members_.is_member(id) &&
        !gates_.is_gated(name))
      status.free_running.push_back(name);
  }
}

}  // namespace visum::gateway
