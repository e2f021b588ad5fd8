// What is asked of time: pause, speed, reset, snapshots; and the server's own state.
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
  status.frozen_reason = frozen_reason(now);
  status.clock = scene::name_of(world_.clock);
  status.speed = now.pace.speed;
  status.real_time_factor = now.pace.real_time_factor;
  status.overruns = pacer_.overruns();
  status.lateness_p50_ns = pacer_.lateness().quantile(0.5);
  status.lateness_p999_ns = pacer_.lateness().quantile(0.999);
  status.lateness_max_ns = pacer_.lateness().max();
  status.state_hash = gateway::state_hash(now);
  status.solver_warnings = now.solver_warnings;
  status.sessions = static_cast<std::uint32_t>(clients_.size());
  status.refused = refused_;
  status.buses = buses_;
  if (world_.stuck_node) {
    const StuckNode stuck = world_.stuck_node();
    status.stuck_node = stuck.node;
    status.stuck_ns = std::chrono::nanoseconds(stuck.since).count();
  }
  for (const auto& member : members_.all()) {
    const auto waited = member.waited_since ? clock_() - *member.waited_since : Member::Clock::duration{};
    status.lockstep.push_back({member.client, member.granted_tick, std::chrono::nanoseconds(waited).count(),
                               member.grade, member.note});
  }
  for (const auto& [id, client] : clients_)
    if (client.session->role() >= protocol::Role::kController && !members_.is_member(id) && !is_gated(client))
      status.free_running.push_back(client.session->client_name());
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

void Gateway::handle(const Call& call, const protocol::Pause& request) {
  send_command(call, request);
}
void Gateway::handle(const Call& call, const protocol::Resume& request) {
  send_command(call, request);
}

void Gateway::handle(const Call& call, const protocol::Step& request) {
  constexpr std::int64_t kMostTicks = 1'000'000'000;
  if (request.ticks < 1 || request.ticks > kMostTicks)
    return call.fail(ErrorCode::kBadValue, "ticks must be within 1 and " + std::to_string(kMostTicks));
  send_command(call, request);
}

void Gateway::handle(const Call& call, const protocol::SetSpeed& request) {
  if (world_.clock != scene::ClockKind::kRealtime)
    return call.fail(ErrorCode::kWrongState, "the clock is " + std::string(scene::name_of(world_.clock)) +
                                                 "; only realtime has a speed");
  if (!(request.factor >= scene::kLeastSpeed && request.factor <= scene::kMostSpeed))
    return call.fail(ErrorCode::kBadValue, "the speed must be within 0.001 and 1000");
  send_command(call, request);
}

void Gateway::handle(const Call& call, const protocol::Reset& request) {
  send_command(call, request);
}
void Gateway::handle(const Call& call, const protocol::TakeSnapshot& request) {
  send_command(call, request);
}
void Gateway::handle(const Call& call, const protocol::RestoreSnapshot& request) {
  send_command(call, request);
}

void Gateway::handle(const Call& call, const protocol::Shutdown&) {
  shutdown_asked_ = true;
  mailbox_.wake();
  call.reply(protocol::Ok{});
}

}  // namespace visum::gateway
