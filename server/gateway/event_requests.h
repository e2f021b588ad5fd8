// Requests about events: who wants to hear of them, and what clients announce themselves.
#pragma once

#include <string>
#include <vector>

#include "server/gateway/call.h"
#include "server/gateway/log_tap.h"

namespace visum::gateway {

// Lives on the sessions' thread, owned by the Gateway.
class EventRequests {
 public:
  // `log`: null where the log is not told to clients.
  EventRequests(Clients& clients, LogTap* log) : clients_(clients), log_(log) {}

  void handle(const Call& call, const protocol::SubscribeEvents& request);
  void handle(const Call& call, const protocol::UnsubscribeEvents&);
  void handle(const Call& call, const protocol::Announce& request);

  // The request has been carried out: tells what is worth to be told of it.
  void tell_done(const protocol::Request& request, const protocol::Reply& reply, const std::string& client,
                 const Published& now);
  // Tells the log's new lines.
  void serve(const Published& now);

 private:
  Clients& clients_;
  LogTap* const log_;
  std::vector<LogTap::Line> lines_;
};

}  // namespace visum::gateway
