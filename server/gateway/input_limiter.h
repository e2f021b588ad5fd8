// Limits how many inputs each session may send for one tick, and hands out the mailbox's blank inputs.
#pragma once

#include <cstdint>
#include <map>

#include "server/gateway/call.h"
#include "server/gateway/mailbox.h"

namespace visum::gateway {

inline constexpr const char* kTooManyInputs = "too many inputs wait for the next tick";

// Inputs are what the tick's thread applies at the next tick border: writes, leases, pushes, faults. Without
// a limit, one session could fill the mailbox for all. Lives on the sessions' thread, owned by the Gateway.
class InputLimiter {
 public:
  static constexpr int kMaxPerTick = 8;        // of a session, in realtime; more are refused
  static constexpr int kMaxSingleWrites = 64;  // of a session, with the other clocks; later ones go together

  InputLimiter(scene::ClockKind clock, Mailbox& mailbox)
      : realtime_(clock == scene::ClockKind::kRealtime), mailbox_(mailbox) {}

  // True: the session has sent as many inputs for the tick after `tick` as one tick takes one by one. A
  // session that is gone has sent none.
  bool has_sent_enough(std::uint64_t session, std::int64_t tick);
  void count(std::uint64_t session, std::int64_t tick);
  void forget(std::uint64_t session) { sent_.erase(session); }

  // A blank input, to be filled and sent. Counts for the session. None: the call has failed with kBusy.
  Input* blank_or_fail(const Call& call);
  // Likewise, but counts for nobody and takes those that are kept back: for what must not be lost.
  Input* urgent_blank_or_fail(const Call& call);

 private:
  struct Sent {
    std::int64_t tick = -1;
    int inputs = 0;
  };
  const bool realtime_;
  Mailbox& mailbox_;
  std::map<std::uint64_t, Sent> sent_;  // by session
};

// Puts inputs that need no lease in an order that does not depend on arrival: a hash of the client's name,
// which is the same number in every run.
std::uint64_t order_of(const Call& call);

}  // namespace visum::gateway
