// A request in hand: who asked, of which copy of the world it is answered, and how to answer.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/gateway/clients.h"
#include "server/gateway/published.h"
#include "server/gateway/static_world.h"

namespace visum::gateway {

// Made by the Gateway for each request, and valid while the request is handled.
struct Call {
  Clients& clients;
  Client& client;
  protocol::Session& session;  // the client's
  std::uint64_t id;            // of the request; 0: no reply is wanted where it succeeds
  const Published& now;

  void reply(const protocol::Reply& reply) const;
  // An error is sent to requests without an id, too. `owner`: who holds the lease that was missing.
  void fail(protocol::ErrorCode code, const std::string& text, const std::string& owner = {}) const;
};

// The number of a part; none: there is no such part, and the call has failed with that.
std::optional<std::uint32_t> part_or_fail(const Call& call, const StaticWorld& world,
                                          const std::string& name);

}  // namespace visum::gateway
