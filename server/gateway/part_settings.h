// Requests about a part's parameters and blackboards.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/gateway/blackboard_locks.h"
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
  void handle(const Call& call, const protocol::LockBlackboard& request);
  void handle(const Call& call, const protocol::UnlockBlackboard& request);

 private:
  // False: there is no such blackboard, or it cannot be written, and the call has failed with that.
  bool blackboard_or_fail(const Call& call, std::uint32_t part, const std::string& name, bool to_write) const;

  // The part, if the session may write this blackboard of it; otherwise the call has failed.
  std::optional<std::uint32_t> writable_or_fail(const Call& call, const std::string& part,
                                                const std::string& name) const;

  const StaticWorld& world_;
  const Parts& parts_;
  Commands& commands_;
  BlackboardLocks locks_;
};

}  // namespace visum::gateway
