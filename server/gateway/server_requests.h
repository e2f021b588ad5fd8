// Requests about the server itself: its state, and its end.
#pragma once

#include <atomic>

#include "server/bus/bus_door.h"
#include "server/cycle/pacer.h"
#include "server/gateway/call.h"
#include "server/gateway/lockstep.h"
#include "server/gateway/mailbox.h"

namespace visum::gateway {

// Lives on the sessions' thread, owned by the Gateway. Of the pacer only the counters are read, which any
// thread may do.
class ServerRequests {
 public:
  ServerRequests(const StaticWorld& world, Mailbox& mailbox, const Clients& clients, const Lockstep& lockstep,
                 const cycle::Pacer& pacer, const bus::BusDoor& buses, const Parts& parts)
      : world_(world),
        mailbox_(mailbox),
        clients_(clients),
        lockstep_(lockstep),
        pacer_(pacer),
        buses_(buses),
        parts_(parts) {}

  void handle(const Call& call, const protocol::Hello&);
  void handle(const Call& call, const protocol::Status&) { call.reply(status(call.now)); }
  void handle(const Call& call, const protocol::Shutdown&);

  protocol::ServerStatus status(const Published& now) const;
  // True once a client asked for Shutdown. Any thread.
  bool shutdown_asked() const { return shutdown_asked_.load(std::memory_order_relaxed); }

 private:
  const StaticWorld& world_;
  Mailbox& mailbox_;
  const Clients& clients_;
  const Lockstep& lockstep_;
  const cycle::Pacer& pacer_;
  const bus::BusDoor& buses_;
  const Parts& parts_;
  std::atomic<bool> shutdown_asked_{false};
};

}  // namespace visum::gateway
