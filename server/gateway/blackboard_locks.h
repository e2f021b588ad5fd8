// Blackboards that a session writes in several pieces, and that change at once when it has done so.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/messages.h"
#include "server/gateway/published.h"

namespace visum::gateway {

// The locks and what was written under them. Lives on the sessions' thread, owned by PartSettings, which
// checks names and leases. A lock ends with its time-out, with its session, and with the era: its writes are
// then dropped.
class BlackboardLocks {
 public:
  using Refusal = std::optional<std::pair<protocol::ErrorCode, std::string>>;
  static constexpr std::int64_t kMostTimeout_ns = 60'000'000'000;
  static constexpr std::size_t kMostBytes = 16u << 20;  // that wait under one lock

  Refusal lock(std::uint64_t session, const protocol::LockBlackboard& request, std::int64_t timeout_ticks,
               const Published& now);
  // True: the session has, or had, the lock, so that `write` is kept or `refusal` says why not. False: there
  // is no lock, and the write is to act at once.
  bool keep(std::uint64_t session, const protocol::WriteBlackboard& write, const Published& now,
            Refusal& refusal);
  // Ends the lock. Returns what was written under it, in order.
  std::vector<protocol::WriteBlackboard> unlock(std::uint64_t session,
                                                const protocol::UnlockBlackboard& request,
                                                const Published& now, Refusal& refusal);

 private:
  struct Lock {
    std::uint64_t session = 0, era = 0;
    std::int64_t until_tick = 0;
    std::vector<protocol::WriteBlackboard> writes{};
    std::size_t bytes = 0;

    bool is_over(const Published& now) const { return now.era != era || now.tick >= until_tick; }
  };
  // Null: this session has none.
  Lock* find(std::uint64_t session, const std::string& part, const std::string& name);

  std::map<std::pair<std::string, std::string>, Lock> locks_;  // by part and blackboard
};

}  // namespace visum::gateway
