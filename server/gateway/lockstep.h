// The lockstep: clients that step with the world, how far each lets it run, and what happens to one that is
// late.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "server/bus/bus_door.h"
#include "server/gateway/call.h"
#include "server/gateway/gates.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/members.h"
#include "server/gateway/parts.h"

namespace visum::gateway {

// Answers Join, Advance, Leave and Note, and tells the daemon's loop whether the world may go on. With the
// clocks realtime and free, members only wait for ticks and hold nothing. Lives on the sessions' thread,
// which in lockstep is the tick's thread as well; the Gateway owns it.
class Lockstep {
 public:
  Lockstep(const StaticWorld& world, Mailbox& mailbox, Clients& clients, Parts& parts, bus::BusDoor& buses);

  void handle(const Call& call, const protocol::Join& request);
  void handle(const Call& call, const protocol::Advance& request);
  void handle(const Call& call, const protocol::Leave&);
  void handle(const Call& call, const protocol::Note& request);

  // The daemon's loop.

  // True once a member stepped: time starts. Any thread.
  bool start_asked() const { return start_asked_.load(std::memory_order_relaxed); }
  // True if the world may go on from `tick`. A world without members moves only by Step (`stepping`), or for
  // a client that was late and goes on in real time.
  bool lets(std::int64_t tick, bool stepping) const {
    return members_.empty() ? stepping || has_dropped() : members_.limit() > tick;
  }
  // A client that was late goes on in real time, and so does the world.
  bool has_dropped() const { return !dropped_.empty(); }
  // The client that holds the world at `tick`; empty: none does.
  std::string_view held_by(std::int64_t tick) const {
    const auto* member = members_.held_by(tick);
    return member ? std::string_view(member->client) : std::string_view();
  }
  // Before each tick: lets the world run on from `tick` for members that wait for all others, or has them
  // answered because the number of members is not theirs. True: answers have to be sent.
  bool follow_members(std::int64_t tick);
  // Before each tick: settles the buses for members that ask for it, and stops the world here, at `tick`, for
  // those whose program was told something. True: answers have to be sent.
  bool follow_buses(std::int64_t tick);
  // While the world waits at `tick`: drops a member that has been waited for too long.
  void check_timeouts(std::int64_t tick, const Published& now);
  // While time stands, by a pause or a fault: no member is waited for.
  void end_waits() { members_.end_waits(); }
  // Measures the members' time-outs by this instead of the steady clock. Before the first session.
  void use_clock(std::function<Member::Clock::time_point()> clock) { clock_ = std::move(clock); }

  // The Gateway.

  // True for requests whose answer belongs to a cycle: those of members, and those that begin or end a
  // membership. They are not looked at while a tick is being done.
  bool waits_for_tick(const protocol::Session& session, const protocol::Request& request);
  // A session's request that ends a cycle has to wait until the world has run a period: the tick at which it
  // may be handled. None: it can be handled now.
  std::optional<std::int64_t> hold(const protocol::Session& session, const protocol::Request& request,
                                   const Published& now);
  // In another era the request that a gate held is the first of a new cycle.
  void begin_cycle_with(const protocol::Session& session, const protocol::Request& request);
  // Answers members that wait for a tick that has come, or never will because the world is frozen.
  void answer_advances(const Published& now);
  // The earliest tick at which an Advance is to be answered; none: no member waits.
  std::optional<std::int64_t> next_answer() const { return members_.next_answer(); }
  // A reset or restore: all members stand at this tick, and cycles begin anew.
  void begin_era(const Published& now);
  // These parts went: no member's program commands them any more.
  void forget_parts(std::span<const std::uint32_t> gone);
  // Parts that the session's program commands over their buses.
  std::span<const std::uint32_t> parts_commanded_by(std::uint64_t session) const;
  // The session is gone.
  void remove(std::uint64_t session, const Published& now);
  // Puts the members and the free-running clients into Status.
  void describe(protocol::ServerStatus& status) const;

 private:
  // Out of the lockstep, and its gate with it; requests that the gate holds are handled at once.
  void leave(std::uint64_t session, const Published& now);
  void answer(Member& member, const Published& now);
  protocol::Advanced advanced(const Member& member, const Published& now);
  // Ends every Advance that waits with an error, since the lockstep has broken.
  void end_advances(std::int64_t tick, const std::string& why);
  // Compares what a member has heard of its program's connections with what was said on them by now.
  bool was_told_more(const Follows& follows);

  const StaticWorld& world_;
  Mailbox& mailbox_;
  Clients& clients_;
  Parts& parts_;
  bus::BusDoor& buses_;
  Members members_;
  Gates gates_;
  std::set<std::uint64_t> dropped_;  // sessions that were late and go on in real time
  std::function<Member::Clock::time_point()> clock_ = Member::Clock::now;
  std::atomic<bool> start_asked_{false};
};

}  // namespace visum::gateway
