#include "server/gateway/gates.h"

#include <algorithm>

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

std::string Gates::refuse(const protocol::Gate& gate) const {
  if (world_.clock != scene::ClockKind::kLockstep) return "a gate is for the clock lockstep";
  if (gate.part.empty() == gate.client.empty()) return "a gate has either a part or a client";
  const auto period_ns = period_ns_of(gate);
  if (period_ns < 0 || period_ns % world_.tick_ns != 0 || period_ns / world_.tick_ns > kMostPeriodTicks)
    return "a gate's period must be whole ticks of " + std::to_string(world_.tick_ns) + " ns, at most " +
           std::to_string(kMostPeriodTicks) + " of them";
  if (!gate.part.empty() && !buses_.has(gate.part)) return "the part '" + gate.part + "' has no bus";
  for (const auto& member : members_.all()) {
    const bool same_bus = member.bus_gate && world_.part_name(*member.bus_gate) == gate.part;
    if (same_bus || (member.gate && member.gate->client() == gate.client))
      return "'" + (gate.part.empty() ? gate.client : gate.part) + "' has a gate already, by '" +
             member.client + "'";
  }
  return fault_of_frame(gate);
}

void Gates::open(Member& member, const protocol::Gate& gate) {
  const auto period_ticks = period_ns_of(gate) / world_.tick_ns;
  if (gate.part.empty()) {
    member.gate.emplace(gate.client, period_ticks);
    return;
  }
  for (std::uint32_t part = 0; part < world_.parts.size(); ++part)
    if (world_.part_name(part) == gate.part) member.bus_gate = part;
  buses_.open_gate(*member.bus_gate, rule_of(gate, period_ticks));
}

void Gates::close(const Member& member) {
  if (member.bus_gate) buses_.close_gate(*member.bus_gate);
}

void Gates::follow_bus(Member& member) const {
  if (!member.bus_gate) return;
  const auto granted = buses_.granted_tick(*member.bus_gate);
  if (granted == member.granted_tick) return;
  member.granted_tick = granted;
  member.waited_since.reset();
}

Member* Gates::gate_of(const protocol::Session& session) {
  const auto found = std::ranges::find_if(members_.all(), [&](const Member& member) {
    return member.gate && member.gate->client() == session.client_name() && member.session != session.id();
  });
  return found == members_.all().end() ? nullptr : &*found;
}

bool Gates::is_gated(const std::string& client) const {
  return std::ranges::any_of(
      members_.all(), [&](const Member& member) { return member.gate && member.gate->client() == client; });
}

}  // namespace visum::gateway
