// Requests about the scenes of the installation: a list of them, and another one in the place of the world's.
#pragma once

#include "server/gateway/call.h"
#include "server/gateway/commands.h"

namespace visum::gateway {

// Lives on the sessions' thread, owned by the Gateway.
class SceneRequests {
 public:
  SceneRequests(const StaticWorld& world, Commands& commands) : world_(world), commands_(commands) {}

  void handle(const Call& call, const protocol::ListScenes&);
  void handle(const Call& call, const protocol::LoadScene& request);

 private:
  const StaticWorld& world_;
  Commands& commands_;
};

}  // namespace visum::gateway
