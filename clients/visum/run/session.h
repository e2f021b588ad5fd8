// The runner's own session with the daemon: it steps the world and reads what the checks need.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clients/visum/run/quantity.h"
#include "clients/visum/run/wait_loop.h"
#include "protocol/client.h"

namespace visum::run {

class Session {
 public:
  // In the lockstep, to others: the one that steps, and one that always waits for the next tick. Who keeps
  // the world waiting is timed by the server only while somebody waits; we do not, while we ask who has left.
  static constexpr const char* kName = "scenario";
  static constexpr const char* kWaiterName = "scenario-waits";
  static constexpr std::int64_t kMostTicks = 900'000'000;  // of a run: the waiter waits for a later one

  Session(std::uint16_t port, WaitLoop& wait_loop);

  void join();  // holds the world from now on (lockstep)
  Catalogue catalogue();
  // The state as it is, of the world and of these parts.
  Observation look(const std::set<std::string>& parts);
  // Lets `ticks` pass, then the same, and the server's status at that tick: one wait for all of it. Throws
  // ExitError: kLost where a client in the lockstep timed out and the run ends with that, kFailed where the
  // world froze.
  struct Step {
    Observation now;
    protocol::ServerStatus status;
  };
  Step step(std::int64_t ticks, const std::set<std::string>& parts);
  protocol::ServerStatus status();
  // What the server said of members that were late and are no longer waited for, since the last call.
  std::vector<std::string> take_timeouts() { return std::exchange(timeouts_, {}); }
  protocol::Reply request(const protocol::Request& request) { return connection_.request(request); }

  std::int64_t tick_ns() const { return connection_.welcome().tick_ns; }
  const std::string& clock() const { return connection_.welcome().clock; }

 private:
  void await_advance(std::uint64_t id);
  Observation take(std::span<const std::uint64_t> ids);
  void hear_events();

  WaitLoop& wait_loop_;
  protocol::Connection connection_;
  std::optional<protocol::Connection> waiter_;
  std::uint64_t era_ = 0;
  std::vector<std::string> timeouts_;
};

}  // namespace visum::run
