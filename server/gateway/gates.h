// Grade L1 of the lockstep: programs that know nothing of it let the world run by what they ask.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/server.h"
#include "server/bus/bus_door.h"
#include "server/gateway/members.h"
#include "server/gateway/static_world.h"

namespace visum::gateway {

// A member that joined with a gate lets the world run for a program beside it. The gate watches either the
// telegrams on a part's bus, or the requests of the sessions with a client's name. Lives on the sessions'
// thread; the Lockstep owns it. The gates themselves stand in their Member, those of buses behind the
// BusDoor.
class Gates {
 public:
  Gates(const StaticWorld& world, Members& members, bus::BusDoor& buses)
      : world_(world), members_(members), buses_(buses) {}

  // Why a gate cannot be opened; empty: it can.
  std::string refuse(const protocol::Gate& gate) const;
  void open(Member& member, const protocol::Gate& gate);
  void close(const Member& member);

  // Bus gates: the member lets the world run as far as the requests on its bus do.
  void follow_bus(Member& member) const;
  // Session gates: the member whose gate watches this session; null: no other session's gate does.
  Member* gate_of(const protocol::Session& session);
  // True if any gate is for clients of this name, its own session included.
  bool is_gated(const std::string& client) const;

 private:
  const StaticWorld& world_;
  Members& members_;
  bus::BusDoor& buses_;
};

}  // namespace visum::gateway
