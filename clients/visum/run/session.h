// The runner's own session with the daemon. It steps the world and reads what the checks need. Main thread;
// the runner owns it.
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
  // Our two members of the lockstep: one steps, one always waits for the next tick. The server times a member
  // that keeps the world waiting only while another waits. The first does not wait while it asks which
  // controllers have left.
  static constexpr const char* kName = "scenario";
  static constexpr const char* kWaiterName = "scenario-waits";
  static constexpr std::int64_t kMostTicks =
      900'000'000;  // the longest run; the second member waits for a later tick

  Session(std::uint16_t port, WaitLoop& wait_loop);

  void join();  // holds the world from now on (lockstep)
  Catalogue catalogue();
  // Reads the present state of the world and of these parts.
  Observation look(const std::set<std::string>& parts);
  // Lets `ticks` pass, then reads the same, and the server's status at that tick, with a single wait. Throws
  // ExitError: kLost if a client in the lockstep was late and the run ends with that, kFailed if the world
  // froze.
  struct Step {
    Observation now;
    protocol::ServerStatus status;
  };
  Step step(std::int64_t ticks, const std::set<std::string>& parts);
  protocol::ServerStatus status();
  // The server's messages, since the last call, about members that were late and for which it no longer
  // waits.
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
