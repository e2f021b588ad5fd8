// The clients that step with the world: how far each lets it run, and for which tick it waits.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.h"
#include "server/gateway/session_gate.h"

namespace visum::gateway {

// An Advance with follow_buses tells this about its program's connections.
struct Follows {
  std::uint64_t bus_said = 0;
  std::vector<protocol::Stream> streams;
  bool settled = false;  // all that its program wrote has been handled and answered
};

// An Advance with `members` waits for the others.
struct After {
  std::int64_t ticks = 0;
  std::uint32_t members = 0;
};

struct Member {
  using Clock = std::chrono::steady_clock;
  std::uint64_t session = 0;
  std::string client;
  std::int64_t granted_tick = 0;                  // it lets the world run up to here
  std::optional<std::uint64_t> advance;           // id of the Advance that waits to be answered
  bool answer_may_wait = false;                   // says that Advance
  std::chrono::nanoseconds timeout{};             // 0: none
  std::optional<Clock::time_point> waited_since;  // the world waits for it
  std::optional<Follows> follows;                 // of the Advance that waits
  std::optional<After> after;                     // the Advance that waits lets the world run only later
  std::uint32_t grade = 4;                        // of lockstep: 1, 2 or 4
  protocol::OnTimeout on_timeout = protocol::OnTimeout::kEnd;
  bool own_timeout = false;               // it asked for a time-out, which also holds where it is alone
  std::vector<std::uint32_t> parts;       // its program commands these over their buses
  std::optional<std::uint32_t> bus_gate;  // grade 1: of this part's buses
  std::optional<SessionGate> gate;        // grade 1: of sessions
  std::string note;                       // its own text about what it does, for Status
};

// All members, in the order of joining. In lockstep they hold the world; with the other clocks they only wait
// for it. Lives on the sessions' thread; the Lockstep owns it.
class Members {
 public:
  Member* find(std::uint64_t session);
  bool is_member(std::uint64_t session) const;
  Member& join(std::uint64_t session, const std::string& client, std::int64_t tick,
               std::chrono::nanoseconds timeout);
  bool leave(std::uint64_t session);  // false: it was not a member
  bool empty() const { return members_.empty(); }
  std::vector<Member>& all() { return members_; }
  const std::vector<Member>& all() const { return members_; }

  // The tick up to which all members let the world run.
  std::int64_t limit() const;
  // True if a member other than this one has not let the world run on from `tick`, and is free to do so.
  bool others_hold(const Member& one, std::int64_t tick) const;
  // The member that joined last of those that hold the world at `tick`; null: none does.
  const Member* held_by(std::int64_t tick) const;
  // The earliest tick at which an Advance is to be answered; none: no member waits.
  std::optional<std::int64_t> next_answer() const;
  // Time stands, or a client joined: measuring of waits begins anew.
  void end_waits();
  // After a reset or restore: all members stand at `tick`.
  void rebase(std::int64_t tick);
  // Marks the members that hold the world at `tick` as waited for since `now`, and unmarks the others.
  // Returns the first that has been waited for longer than its time-out; null: there is none. A single member
  // that did not ask for a time-out is waited for without end: it may stand in a debugger for as long as it
  // likes.
  Member* waited_too_long(std::int64_t tick, Member::Clock::time_point now);

 private:
  std::vector<Member> members_;  // in the order of joining
};

}  // namespace visum::gateway
