// The world that a program under the shim keeps in step with: a member of the server's lockstep. One thread.
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
  // Joins: the world stands until advance(). `idle` is called while an answer is waited for, every few
  // milliseconds; where it returns false the wait ends. Throws ExitError(kUsage) where the server's clock is
  // not lockstep.
  WorldLink(protocol::Connection connection, const protocol::Join& join, std::function<bool()> idle);

  std::int64_t tick_ns() const { return connection_.welcome().tick_ns; }
  // Simulated, and going on where the server's goes back (reset, restore).
  std::int64_t now_ns() const { return offset_ns_ + world_ns_; }

  // Lets the world run for at most `ticks` (0: only the buses are served), less where a bus has said
  // something. `streams`: what the program has written, and what it was told; on return what the server has
  // written. False: `idle` ended the wait. Throws ExitError(kLost) where the lockstep is lost.
  bool advance(std::int64_t ticks, std::vector<protocol::Stream>& streams);
  // Whether a bus said something during the last advance().
  bool spoke() const { return spoke_; }

  void note(const std::string& text);  // for `visum status`
  // While the program runs: what the server says unasked. Throws ExitError(kLost) where we were too late, and
  // are to end then; where the program goes on by itself, its time is the wall clock's from now on.
  void look();
  protocol::ServerStatus status();
  void leave();  // in good order

 private:
  using Clock = std::chrono::steady_clock;

  void follow(const protocol::Advanced& advanced);
  void pass_freely(std::int64_t ticks);

  protocol::Connection connection_;
  const protocol::OnTimeout on_timeout_;
  std::function<bool()> idle_;
  std::optional<Clock::time_point> free_since_;  // out of the lockstep
  std::int64_t free_from_ns_ = 0;                // world_ns_ then
  std::int64_t world_ns_ = 0, offset_ns_ = 0;
  std::uint64_t era_ = 0, bus_said_ = 0;
  bool spoke_ = false;
};

}  // namespace visum::exec
