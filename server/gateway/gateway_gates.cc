// Grade L1: whose requests let the world run, by how much, and what waits until it is there.
#include <algorithm>
#include <string>

#include "server/gateway/gateway.h"

namespace visum::gateway {
namespace {

constexpr std::int64_t kUsualPeriod_ns = 10'000'000;
constexpr std::size_t kMostFrameBytes = 8;
constexpr std::uint32_t kMostModule = 31;
constexpr std::int64_t kMostPeriodTicks = 1'000'000;

bus::CycleRule rule_of(const protocol::Gate& gate, std::int64_t period_ticks) {
  bus::CycleRule rule{period_ticks, static_cast<std::uint8_t>(gate.module), {}};
  for (const auto byte : gate.frame) rule.frame.push_back(static_cast<std::uint8_t>(byte));
  return rule;
}

std::int64_t period_ns_of(const protocol::Gate& gate) {
  return gate.period_ns == 0 ? kUsualPeriod_ns : gate.period_ns;
}

std::string fault_of_frame(const protocol::Gate& gate) {
  if (gate.frame.empty()) return gate.module == 0 ? "" : "a gate's module belongs to a frame";
  if (gate.part.empty()) return "a gate's frame belongs to a part";
  if (gate.module < 1 || gate.module > kMostModule) return "a gate's module must be within 1 and 31";
  if (gate.frame.size() > kMostFrameBytes) return "a gate's frame has at most 8 bytes";
  return {};
}

}  // namespace

// Why a gate cannot be; empty: it can.
std::string Gateway::fault_of_gate(const protocol::Gate& gate) const {
  if (world_.clock != scene::ClockKind::kLockstep) return "a gate is for the clock lockstep";
  if (gate.part.empty() == gate.client.empty()) return "a gate has either a part or a client";
  const auto period_ns = period_ns_of(gate);
  if (period_ns < 0 || period_ns % world_.tick_ns != 0 || period_ns / world_.tick_ns > kMostPeriodTicks)
    return "a gate's period must be whole ticks of " + std::to_string(world_.tick_ns) + " ns, at most " +
           std::to_string(kMostPeriodTicks) + " of them";
  if (!gate.part.empty() && std::ranges::find(buses_, gate.part, &protocol::PartBus::part) == buses_.end())
    return "the part '" + gate.part + "' has no bus";
  for (const auto& member : members_.all()) {
    const bool same_bus = member.bus_gate && world_.parts[*member.bus_gate]->description().name == gate.part;
    if (same_bus || (member.gate && member.gate->client() == gate.client))
      return "'" + (gate.part.empty() ? gate.client : gate.part) + "' has a gate already, by '" +
             member.client + "'";
  }
  return fault_of_frame(gate);
}

void Gateway::open_gate(Member& member, const protocol::Gate& gate) {
  const auto period_ticks = period_ns_of(gate) / world_.tick_ns;
  if (gate.part.empty()) {
    member.gate.emplace(gate.client, period_ticks);
    return;
  }
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part)
    if (world_.parts[part]->description().name == gate.part) member.bus_gate = part;
  bus_door_.open_gate(*member.bus_gate, rule_of(gate, period_ticks));
}

// What the requests on the bus let the world run to.
void Gateway::follow_gate(Member& member) {
  const auto granted = bus_door_.granted_tick(*member.bus_gate);
  if (granted == member.granted_tick) return;
  member.granted_tick = granted;
  member.waited_since.reset();
}

// Out of the lockstep, with its gates; what they hold is served.
void Gateway::leave(std::uint64_t session) {
  const auto* member = members_.find(session);
  if (!member) return;
  if (member->bus_gate) bus_door_.close_gate(*member->bus_gate);
  for (auto& [id, client] : clients_)
    if (client.step_until && gate_of(client) == member) client.step_until = now_->tick;
  members_.leave(session);
}

Member* Gateway::gate_of(const Client& client) {
  const auto found = std::ranges::find_if(members_.all(), [&](const Member& member) {
    return member.gate && member.gate->client() == client.session->client_name() &&
           member.session != client.session->id();
  });
  return found == members_.all().end() ? nullptr : &*found;
}

bool Gateway::is_gated(const Client& client) const {
  return std::ranges::any_of(members_.all(), [&](const Member& member) {
    return member.gate && member.gate->client() == client.session->client_name();
  });
}

// True: the request ends a cycle, and waits at the head of the backlog until the world has run its period.
bool Gateway::holds(Client& client, std::uint64_t id, const protocol::Request& request) {
  auto* member = gate_of(client);
  if (!member || !now_->fault.empty() || !member->gate->ends_cycle(request)) return false;
  member->granted_tick = now_->tick + member->gate->period_ticks();
  member->waited_since.reset();
  client.step_until = member->granted_tick;
  client.waiting = true;
  client.backlog.emplace_front(id, request);
  start_asked_ = true;
  mailbox_.wake();
  return true;
}

// In another era: what was held is asked in the cycle that begins with it.
void Gateway::hold_no_longer(Client& client) {
  client.step_until = now_->tick;
  if (auto* member = gate_of(client)) member->gate->ends_cycle(client.backlog.front().second);
}

// What a gate held is served once the world is there, or never will be.
void Gateway::release(Client& client) {
  if (!client.step_until || (now_->tick < *client.step_until && now_->fault.empty())) return;
  if (client.session->behind()) return;
  client.step_until.reset();
  client.waiting = false;
  const auto [id, request] = std::move(client.backlog.front());
  client.backlog.pop_front();
  dispatch(client, id, request);
}

}  // namespace visum::gateway
