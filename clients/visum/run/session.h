// The runner's own session with the daemon. It steps the world and reads what the checks need. Main thread;
// the runner owns it.
#pragma once

#include <cstdint>
#include <deque>
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
  // The drives that are in fault now: "arm: joint_2: following error ...".
  std::vector<std::string> tripped(const Catalogue& catalogue);
  // Reads the present state of the world and of these parts.
  Observation look(const std::set<std::string>& parts);
  // Asks for `count` steps of `ticks` each, behind those that were asked for before, and for the same of the
  // world after each. The world goes on by itself from one to the next. `members`: of the lockstep, ours
  // included; each step then waits until all others let the world go on, and none of the steps is made once
  // their number has changed. 0: does not look at them.
  void send_steps(std::size_t count, std::int64_t ticks, const std::set<std::string>& parts,
                  std::uint32_t members);
  std::size_t steps_ahead() const { return steps_.size(); }           // sent, and not yet taken
  static std::size_t most_steps(const std::set<std::string>& parts);  // that may be sent ahead
  // Waits for the next of these steps. Returns nothing if the number of members has changed: the world stands
  // where it was, and the steps sent ahead are forgotten. Throws ExitError: kLost if a client in the lockstep
  // was late and the run ends with that, kFailed if the world froze.
  std::optional<Observation> take_step();
  protocol::ServerStatus status();
  void end_world();  // the server ends; does not wait for that
  // The server's messages, since the last call, about members that were late and for which it no longer
  // waits.
  std::vector<std::string> take_timeouts() { return std::exchange(timeouts_, {}); }
  protocol::Reply request(const protocol::Request& request) { return connection_.request(request); }
  void post(const protocol::Request& request) { connection_.post(request); }  // no answer is wanted

  std::int64_t tick_ns() const { return connection_.welcome().tick_ns; }
  const std::string& clock() const { return connection_.welcome().clock; }

 private:
  protocol::Advanced await_advance(std::uint64_t id);
  Observation take(std::span<const std::uint64_t> ids);
  void hear_events();

  WaitLoop& wait_loop_;
  protocol::Connection connection_;
  std::optional<protocol::Connection> waiter_;
  std::uint64_t era_ = 0;
  std::int64_t tick_ = 0;                         // of the last answer
  std::deque<std::vector<std::uint64_t>> steps_;  // sent ahead: the requests of each
  std::vector<std::string> timeouts_;
};

}  // namespace visum::run
