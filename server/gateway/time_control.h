// Requests about time: pause, speed, single steps, reset, snapshots and recordings.
#pragma once

#include "server/gateway/commands.h"

namespace visum::gateway {

// Checks the request; the tick's thread carries it out. Lives on the sessions' thread, owned by the Gateway.
class TimeControl {
 public:
  TimeControl(const StaticWorld& world, Commands& commands) : world_(world), commands_(commands) {}

  void handle(const Call& call, const protocol::Pause& request) { commands_.send(call, request); }
  void handle(const Call& call, const protocol::Resume& request) { commands_.send(call, request); }
  void handle(const Call& call, const protocol::Step& request);
  void handle(const Call& call, const protocol::SetSpeed& request);
  void handle(const Call& call, const protocol::Reset& request) { commands_.send(call, request); }
  void handle(const Call& call, const protocol::TakeSnapshot& request);
  void handle(const Call& call, const protocol::RestoreSnapshot& request);
  void handle(const Call& call, const protocol::StartRecording& request);
  void handle(const Call& call, const protocol::StopRecording& request) { commands_.send(call, request); }

 private:
  const StaticWorld& world_;
  Commands& commands_;
};

}  // namespace visum::gateway
