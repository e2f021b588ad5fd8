// The runner's own session with the daemon: it steps the world and reads what the checks need.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "clients/visum/run/quantity.h"
#include "clients/visum/run/vigil.h"
#include "protocol/client.h"

namespace visum::run {

class Session {
 public:
  static constexpr const char* kName = "scenario";  // in the lockstep, to others

  Session(std::uint16_t port, Vigil& vigil);

  void join();  // holds the world from now on (lockstep)
  Catalogue catalogue();
  // The state as it is, of the world and of these parts.
  Observation look(const std::set<std::string>& parts);
  // Lets `ticks` pass, then the same: one wait for all of it. Throws ExitError: kLost where a client in the
  // lockstep timed out, kFailed where the world froze.
  Observation step(std::int64_t ticks, const std::set<std::string>& parts);
  protocol::ServerStatus status();
  protocol::Reply request(const protocol::Request& request) { return connection_.request(request); }

  std::int64_t tick_ns() const { return connection_.welcome().tick_ns; }
  const std::string& clock() const { return connection_.welcome().clock; }

 private:
  Observation take(std::uint64_t world_id, const std::vector<std::uint64_t>& part_ids);
  void hear_events();

  Vigil& vigil_;
  protocol::Connection connection_;
};

}  // namespace visum::run
