#include "server/gateway/daemon_buses.h"

#include <utility>

namespace visum::gateway {

void DaemonBuses::open(cycle::Simulation& simulation, const std::vector<bus::BusAddress>& addresses,
                       std::function<void()> wake) {
  if (!addresses.empty()) buses_.emplace(simulation, addresses, std::move(wake));
}

const bus::BusNames& DaemonBuses::names() const {
  static const bus::BusNames kNone;
  return buses_ ? buses_->names() : kNone;
}

const std::vector<protocol::PartBus>& DaemonBuses::addresses() const {
  return buses_ ? buses_->addresses() : bus::NoBuses::instance().addresses();
}

bool DaemonBuses::serve() {
  if (!buses_ || !buses_->serve()) return false;
  tick_side_.start();
  return true;
}

void DaemonBuses::settle(const std::vector<protocol::Stream>& streams) {
  if (!buses_ || !buses_->settle(streams)) return;
  tick_side_.start();
  tick_side_.touch();
}

void DaemonBuses::open_gate(std::uint32_t part, bus::CycleRule rule) {
  if (buses_) buses_->open_gate(part, std::move(rule));
}

}  // namespace visum::gateway
