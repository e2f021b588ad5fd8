// What is asked of time: lockstep, pause, speed, reset, snapshots; and the server's own state.
#include <cmath>
#include <string>

#include "server/gateway/gateway.h"

namespace visum::gateway {

using protocol::ErrorCode;

void Gateway::handle(const Call& call, const protocol::Hello&) {
  call.fail(ErrorCode::kMalformed, "hello was said already");
}

protocol::ServerStatus Gateway::server_status(const Published& now) const {
  protocol::ServerStatus status;
  status.tick = now.tick;
  status.sim_time_ns = now.sim_time_ns;
  status.era = now.era;
  status.paused = now.pace.paused;
  status.frozen = !now.fault.empty();
  status.frozen_reason = now.fault;
  status.clock = to_string(world_.clock);
  status.speed = now.pace.speed;
  status.real_time_factor = now.pace.real_time_factor;
  status.overruns = pacer_.overruns();
  status.lateness_p50_ns = pacer_.lateness().quantile(0.5);
  status.lateness_p999_ns = pacer_.lateness().quantile(0.999);
  status.lateness_max_ns = pacer_.lateness().max();
  status.state_hash = now.state_hash;
  status.sessions = static_cast<std::uint32_t>(clients_.size());
  status.refused = refused_;
  status.buses = buses_;
  for (const auto& member : members_.all()) {
    const auto waited =
        member.waited_since ? Member::Clock::now() - *member.waited_since : Member::Clock::duration{};
    status.lockstep.push_back({member.client, member.granted_tick, std::chrono::nanoseconds(waited).count()});
  }
  for (std::size_t i = 0; i < cycle::kPhases; ++i)
    status.phases.push_back({cycle::kPhaseNames[i], now.phases[i].mean_ns, now.phases[i].max_ns});
  return status;
}

void Gateway::handle(const Call& call, const protocol::Status&) {
  call.reply(server_status(*now_));
}

Metrics Gateway::metrics() {
  return {server_status(latest_()), part_list().parts, 0, lease_losses_, freezes_};
}

void Gateway::handle(const Call& call, const protocol::Join& request) {
  if (members_.find(call.session.id()))
    return call.fail(ErrorCode::kWrongState, "this session has joined already");
  if (request.timeout_ns < 0) return call.fail(ErrorCode::kBadValue, "timeout_ns must not be negative");
  const auto& now = *now_;
  const auto timeout =
      request.timeout_ns > 0 ? std::chrono::nanoseconds(request.timeout_ns) : world_.lockstep_timeout;
  members_.join(call.session.id(), call.session.client_name(), now.tick, timeout);
  call.reply(protocol::Advanced{now.tick, now.sim_time_ns, now.era});
}

void Gateway::handle(const Call& call, const protocol::Advance& request) {
  constexpr std::int64_t kMostTicks = 1'000'000'000;
  auto* member = members_.find(call.session.id());
  if (!member) return call.fail(ErrorCode::kWrongState, "Advance needs Join first");
  if (member->advance) return call.fail(ErrorCode::kWrongState, "the previous Advance is not yet answered");
  if (request.ticks < 1 || request.ticks > kMostTicks)
    return call.fail(ErrorCode::kBadValue, "ticks must be within 1 and " + std::to_string(kMostTicks));
  const auto& now = *now_;
  if (!now.fault.empty()) return call.fail(ErrorCode::kFrozen, now.fault);
  // Who comes later than a whole period in realtime or free starts anew from now: no burst of answers.
  if (now.tick - member->granted_tick > request.ticks) member->granted_tick = now.tick;
  member->granted_tick += request.ticks;
  member->advance = call.id;
  call.client.waiting = true;
  start_asked_ = true;
  mailbox_.wake();
  answer(*member, now);
}

void Gateway::handle(const Call& call, const protocol::Leave&) {
  if (!members_.leave(call.session.id()))
    return call.fail(ErrorCode::kWrongState, "this session has not joined");
  call.reply(protocol::Ok{});
}

void Gateway::answer_advances(const Published& now) {
  for (auto& member : members_.all()) answer(member, now);
}

// Answers a member that waits for a tick that has come, or never will.
void Gateway::answer(Member& member, const Published& now) {
  if (!member.advance || (now.fault.empty() && now.tick < member.granted_tick)) return;
  auto& client = clients_.at(member.session);
  if (now.fault.empty())
    client.session->send(*member.advance, protocol::Advanced{now.tick, now.sim_time_ns, now.era});
  else
    client.session->send(*member.advance, protocol::Error{ErrorCode::kFrozen, now.fault, {}});
  member.advance.reset();
  client.waiting = false;
}

void Gateway::check_timeouts(std::int64_t tick) {
  const auto now = Member::Clock::now();
  const auto* late = members_.waited_too_long(tick, now);
  if (!late) return;
  const auto session = late->session;
  const std::string text = "'" + late->client + "' held the lockstep at tick " + std::to_string(tick) +
                           " for longer than its time-out";
  for (auto& member : members_.all()) {
    if (!member.advance) continue;
    auto& client = clients_.at(member.session);
    client.session->send(*member.advance, protocol::Error{ErrorCode::kTimeout, text, {}});
    client.waiting = false;
    member.advance.reset();
    member.granted_tick = tick;
    member.waited_since.reset();
  }
  members_.leave(session);
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part)
    if (leases_.held_by(part, session)) lose_lease(part, text);
  broadcast({"lockstep_timeout", text, {}, era_, tick});
}

void Gateway::handle(const Call& call, const protocol::Pause& request) {
  send_errand(call, request);
}
void Gateway::handle(const Call& call, const protocol::Resume& request) {
  send_errand(call, request);
}

void Gateway::handle(const Call& call, const protocol::Step& request) {
  constexpr std::int64_t kMostTicks = 1'000'000'000;
  if (request.ticks < 1 || request.ticks > kMostTicks)
    return call.fail(ErrorCode::kBadValue, "ticks must be within 1 and " + std::to_string(kMostTicks));
  send_errand(call, request);
}

void Gateway::handle(const Call& call, const protocol::SetSpeed& request) {
  if (world_.clock != scene::ClockKind::kRealtime)
    return call.fail(ErrorCode::kWrongState,
                     std::string("the clock is ") + to_string(world_.clock) + "; only realtime has a speed");
  if (!(request.factor >= 1e-3 && request.factor <= 1e3))
    return call.fail(ErrorCode::kBadValue, "the speed must be within 0.001 and 1000");
  send_errand(call, request);
}

void Gateway::handle(const Call& call, const protocol::Reset& request) {
  send_errand(call, request);
}
void Gateway::handle(const Call& call, const protocol::TakeSnapshot& request) {
  send_errand(call, request);
}
void Gateway::handle(const Call& call, const protocol::RestoreSnapshot& request) {
  send_errand(call, request);
}

void Gateway::handle(const Call& call, const protocol::Shutdown&) {
  shutdown_asked_ = true;
  mailbox_.wake();
  call.reply(protocol::Ok{});
}

}  // namespace visum::gateway
