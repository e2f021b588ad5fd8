// The server's own state in the format of Prometheus (text format 0.0.4). Pure functions; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::gateway {

struct Metrics {
  protocol::ServerStatus status;
  std::vector<protocol::PartSummary> parts;
  std::uint64_t refused_connections = 0;  // sessions, frames and HTTP requests turned away
  std::uint64_t lease_losses = 0;         // leases that ended without a release
  std::uint64_t freezes = 0;              // numerical faults of the world
};

std::string to_prometheus(const Metrics& metrics);

}  // namespace visum::gateway
