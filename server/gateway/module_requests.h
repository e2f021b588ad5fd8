// Requests about the modules of controllers: what clients announce of themselves is kept and relayed, and
// changes nothing of the world.
#pragma once

#include "protocol/module_board.h"
#include "server/gateway/call.h"

namespace visum::gateway {

// Lives on the sessions' thread, owned by the Gateway.
class ModuleRequests {
 public:
  explicit ModuleRequests(Clients& clients) : clients_(clients) {}

  void handle(const Call& call, const protocol::AnnounceModules& request);
  void handle(const Call& call, const protocol::ReportModules& request);
  void handle(const Call& call, const protocol::ListModules& request);
  void handle(const Call& call, const protocol::OverrideModulePort& request);
  void handle(const Call& call, const protocol::SetModuleParameter& request);

  void end_session(std::uint64_t session) { board_.forget(session); }

 private:
  // Sends an order to the client that has announced the part, and tells of it as an event.
  template <typename Order>
  void relay(const Call& call, const Order& order, const char* kind, const std::string& what);

  Clients& clients_;
  protocol::ModuleBoard board_;
};

}  // namespace visum::gateway
