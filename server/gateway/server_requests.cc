#include "server/gateway/server_requests.h"

#include <chrono>
#include <vector>

#include "server/gateway/working_text.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

constexpr std::chrono::milliseconds kLong{100};  // a phase of a tick that lasts so long is shown

}  // namespace

void ServerRequests::handle(const Call& call, const protocol::Hello&) {
  call.fail(ErrorCode::kMalformed, "hello was said already");
}

void ServerRequests::handle(const Call& call, const protocol::Shutdown&) {
  shutdown_asked_ = true;
  mailbox_.wake();
  call.reply(protocol::Ok{});
}

protocol::ServerStatus ServerRequests::status(const Published& now) const {
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
  status.state_hash = state_hash(now);
  status.solver_warnings = now.solver_warnings;
  status.silent_stops = now.silent_stops;
  status.late_writes = now.late_writes + parts_.refused_late();
  status.limited_ticks = now.limited_ticks;
  status.limited_bodies = now.limited_bodies;
  status.sessions = static_cast<std::uint32_t>(clients_.size());
  status.refused = clients_.refused();
  status.buses = buses_.addresses();
  for (const auto& [client, count] : clients_.exchanges()) status.exchanges.push_back({client, count});
  status.bus_exchanges = buses_.exchanges();
  status.bus_drops = buses_.dropped();
  if (world_.stuck_node) {
    const StuckNode stuck = world_.stuck_node();
    status.stuck_node = stuck.node;
    status.stuck_ns = std::chrono::nanoseconds(stuck.since).count();
  }
  const auto work = world_.working->now();
  const auto lasts = cycle::Working::Clock::now() - work.since;
  if (work.stage != cycle::Stage::kNothing && lasts >= kLong) {
    std::vector<const hwparts::Part*> parts;  // by their numbers in the world
    for (const auto part : now.table->slot_of) parts.push_back(now.table->slots[part].part.get());
    status.working = working_text(work, parts, *now.work_texts);
    status.working_ns = std::chrono::nanoseconds(lasts).count();
  }
  lockstep_.describe(status);
  for (std::size_t i = 0; i < cycle::kPhases; ++i)
    status.phases.push_back({cycle::kPhaseNames[i], now.phases[i].mean_ns, now.phases[i].max_ns});
  return status;
}

}  // namespace visum::gateway
