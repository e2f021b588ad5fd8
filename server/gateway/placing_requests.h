// Requests that put bodies and joints elsewhere, or pull a body.
#pragma once

#include <cstdint>
#include <vector>

#include "server/gateway/commands.h"
#include "server/gateway/parts.h"
#include "server/gateway/world_requests.h"

namespace visum::gateway {

// Checks the numbers here; names are looked up, and bodies moved, on the tick's side between two ticks, which
// answers. Lives on the sessions' thread, owned by the Gateway.
class PlacingRequests {
 public:
  PlacingRequests(Mailbox& mailbox, const WorldRequests& bodies, const Parts& parts, Commands& commands)
      : mailbox_(mailbox), bodies_(bodies), parts_(parts), commands_(commands) {}

  void handle(const Call& call, const protocol::SetBody& request);
  // Refused where another session holds the lease of a part that drives one of the joints.
  void handle(const Call& call, const protocol::SetJoints& request);
  void handle(const Call& call, const protocol::PullBody& request);
  void handle(const Call& call, const protocol::ReleaseBody& request);

  // The session is gone: its pulls end, and kinematic things that it moves stand still.
  void end_session(const Client& client);
  // Sends what end_session() found no room for.
  void serve();

 private:
  Mailbox& mailbox_;
  const WorldRequests& bodies_;
  const Parts& parts_;
  Commands& commands_;
  std::vector<std::uint64_t> ended_;  // sessions of which the tick's side is still to be told
};

}  // namespace visum::gateway
