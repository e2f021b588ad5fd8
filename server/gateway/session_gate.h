// Grade L1 of the lockstep for clients of the ports: decides which of their requests ends a cycle.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "protocol/messages.h"

namespace visum::gateway {

// Lives on the sessions' thread; its Member owns it.
class SessionGate {
 public:
  // For the sessions of clients with this name.
  SessionGate(std::string client, std::int64_t period_ticks)
      : client_(std::move(client)), period_ticks_(period_ticks) {}

  const std::string& client() const { return client_; }
  std::int64_t period_ticks() const { return period_ticks_; }
  // True if this was asked already in this cycle. If so the cycle is over, and the next begins with this
  // request. Only requests that read or write the world's state belong to a cycle.
  bool ends_cycle(const protocol::Request& request);
  void restart() { asked_.clear(); }  // another era: a cycle begins

 private:
  std::string client_;
  std::int64_t period_ticks_;
  std::set<std::string> asked_;
};

}  // namespace visum::gateway
