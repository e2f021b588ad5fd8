// Requests about faults on purpose.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/bus/bus_door.h"
#include "server/gateway/input_limiter.h"
#include "server/gateway/mailbox.h"

namespace visum::gateway {

// Checks a fault against the table of faults and its part, and latches it as a write is latched: it acts from
// a tick border on. Lives on the sessions' thread, owned by the Gateway.
class FaultRequests {
 public:
  FaultRequests(const StaticWorld& world, Mailbox& mailbox, InputLimiter& limiter, const bus::BusDoor& buses)
      : world_(world), mailbox_(mailbox), limiter_(limiter), buses_(buses) {}

  void handle(const Call& call, const protocol::InjectFault& request);
  void handle(const Call& call, const protocol::ClearFault& request);
  void handle(const Call& call, const protocol::ListFaults& request);

 private:
  // Why the part cannot have this fault. Also checks what the part itself cannot know: whether a bus leads to
  // its modules, and how long a tick is.
  std::optional<std::string> refuse(std::uint32_t part, const hwparts::Fault& fault) const;

  const StaticWorld& world_;
  Mailbox& mailbox_;
  InputLimiter& limiter_;
  const bus::BusDoor& buses_;
};

}  // namespace visum::gateway
