// The clients that step with the world: how far each lets it run, and who waits for which tick. In lockstep
// they hold the world; with the other clocks they only wait for it. Lives on the sessions' thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.h"
#include "server/gateway/session_gate.h"

namespace visum::gateway {

// What an Advance with follow_buses said.
struct Follows {
  std::uint64_t bus_said = 0;
  std::vector<protocol::Stream> streams;
  bool settled = false;  // what its program wrote has been obeyed and answered
};

struct Member {
  using Clock = std::chrono::steady_clock;
  std::uint64_t session = 0;
  std::string client;
  std::int64_t granted_tick = 0;                  // lets the world run up to here
  std::optional<std::uint64_t> advance;           // id of the Advance that waits to be answered
  std::chrono::nanoseconds timeout{};             // 0: none
  std::optional<Clock::time_point> waited_since;  // the world waits for it
  std::optional<Follows> follows;                 // of the Advance that waits
  std::uint32_t grade = 4;                        // of lockstep: 1, 2 or 4
  protocol::OnTimeout on_timeout = protocol::OnTimeout::kEnd;
  bool own_timeout = false;               // it asked for one, and has it also where it is alone
  std::vector<std::uint32_t> parts;       // that its program commands by their buses
  std::optional<std::uint32_t> bus_gate;  // grade 1: of this part's buses
  std::optional<SessionGate> gate;        // grade 1: of sessions
  std::string note;                       // its own, what it is busy with
};

class Members {
 public:
  Member* find(std::uint64_t session);
  bool is_member(std::uint64_t session) const;
  Member& join(std::uint64_t session, const std::string& client, std::int64_t tick,
               std::chrono::nanoseconds timeout);
  bool leave(std::uint64_t session);  // false: was none
  bool empty() const { return members_.empty(); }
  std::vector<Member>& all() { return members_; }
  const std::vector<Member>& all() const { return members_; }

  // The tick up to which all let the world run.
  std::int64_t limit() const;
  // The earliest tick at which an Advance is to be answered; none: nobody waits.
  std::optional<std::int64_t> next_answer() const;
  // Time stands, or somebody came: nobody has been waited for until now.
  void end_waits();
  // After a reset or restore: everybody stands at `tick`.
  void rebase(std::int64_t tick);
  // Marks those that hold the world at `tick` as waited for since `now`, unmarks the rest. Returns the first
  // that has been waited for longer than its time-out, where it has one. Who is alone and asked for none is
  // waited for without end: he may stand in a debugger for as long as he likes.
  Member* waited_too_long(std::int64_t tick, Member::Clock::time_point now);

 private:
  std::vector<Member> members_;  // in the order of joining
};

}  // namespace visum::gateway
