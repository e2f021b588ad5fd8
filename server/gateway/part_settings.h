// Requests about a part's parameters and blackboards.
#pragma once

#include <cstdint>
#include <string>

#include "server/gateway/commands.h"
#include "server/gateway/parts.h"

namespace visum::gateway {

// Checks names and leases; the tick's thread reads and writes. Lives on the sessions' thread, owned by the
// Gateway.
class PartSettings {
 public:
  PartSettings(const StaticWorld& world, const Parts& parts, Commands& commands)
      : world_(world), parts_(parts), commands_(commands) {}

  // Stops the part of an emergency stop whose turn among its client's requests has not come yet.
  void press_early(const protocol::SetParameter& stop);

  void handle(const Call& call, const protocol::GetParameters& request);
  void handle(const Call& call, const protocol::SetParameter& request);
  void handle(const Call& call, const protocol::ReadBlackboard& request);
  void handle(const Call& call, const protocol::WriteBlackboard& request);

 private:
  // False: there is no such blackboard, or it cannot be written, and the call has failed with that.
  bool blackboard_or_fail(const Call& call, std::uint32_t part, const std::string& name, bool to_write) const;

  const StaticWorld& world_;
  const Parts& parts_;
  Commands& commands_;
};

}  // namespace visum::gateway
