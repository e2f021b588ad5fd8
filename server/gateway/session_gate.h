// Grade L1 for clients of the ports: what of their requests ends a cycle. Lives on the sessions' thread.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "protocol/messages.h"

namespace visum::gateway {

class SessionGate {
 public:
  // For the sessions of this name.
  SessionGate(std::string client, std::int64_t period_ticks)
      : client_(std::move(client)), period_ticks_(period_ticks) {}

  const std::string& client() const { return client_; }
  std::int64_t period_ticks() const { return period_ticks_; }
  // Whether this was asked already in this cycle: then the cycle is over, and another begins with it. Only
  // what reads or writes the world's state belongs to a cycle.
  bool ends_cycle(const protocol::Request& request);
  void restart() { asked_.clear(); }  // another era: a cycle begins

 private:
  std::string client_;
  std::int64_t period_ticks_;
  std::set<std::string> asked_;
};

}  // namespace visum::gateway
