// The connection to the world that a program keeps in step with; a member of the server's lockstep. Lives on
// the scheduler's thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/client.h"

namespace visum::exec {

class WorldLink {
 public:
  // Joins: the world stands until advance(). While waiting for an answer it calls `idle` every few
  // milliseconds, and ends the wait where `idle` returns false. Throws ExitError(kUsage) where the server's
  // clock is not lockstep.
  WorldLink(protocol::Connection connection, const protocol::Join& join, std::function<bool()> idle);

  std::int64_t tick_ns() const { return connection_.welcome().tick_ns; }
  // Simulated time. Goes on where the server's own goes back (reset, restore).
  std::int64_t now_ns() const { return offset_ns_ + world_ns_; }

  // Lets the world run for at most `ticks` (0: serves the buses only), and stops where a bus sends something.
  // `streams` tells how much the program has written and received on each connection; on return, how much the
  // server has written. False where `idle` ended the wait. Throws ExitError(kLost) where the lockstep is
  // lost.
  bool advance(std::int64_t ticks, std::vector<protocol::Stream>& streams);
  // True if a bus sent something during the last advance().
  bool spoke() const { return spoke_; }

  void note(const std::string& text);  // for `visum status`
  // Reads the server's events; call it while the program runs. Throws ExitError(kLost) where we were too late
  // and the run ends by that. Where the program goes on by itself, its time is the wall clock's from now on.
  void look();
  protocol::ServerStatus status();
  void leave();  // its parts go on with their last commands

 private:
  using Clock = std::chrono::steady_clock;

  // Goes on in real time if there is a reason to, or throws.
  void take_reason(const std::optional<std::string>& why);
  void follow(const protocol::Advanced& advanced);
  void pass_freely(std::int64_t ticks);

  protocol::Connection connection_;
  const protocol::OnTimeout on_timeout_;
  std::function<bool()> idle_;
  std::optional<Clock::time_point> free_since_;  // when it left the lockstep
  std::int64_t free_from_ns_ = 0;                // world_ns_ then
  std::int64_t world_ns_ = 0, offset_ns_ = 0;
  std::uint64_t era_ = 0, bus_said_ = 0;
  bool spoke_ = false;
};

}  // namespace visum::exec
