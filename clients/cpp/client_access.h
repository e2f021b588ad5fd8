// The session below a Client, for libraries of ours that need messages which visum.h does not offer. Same
// thread and same rules as the Client's.
#pragma once

#include <optional>

#include "clients/cpp/visum.h"
#include "protocol/messages.h"

namespace visum {

struct ClientAccess {
  // One round trip. A refusal throws visum::Error.
  static protocol::Reply request(Client& client, const protocol::Request& request);
  // Sends without waiting. A refusal comes by next().
  static void post(Client& client, const protocol::Request& request);
  // A message that answers no request and has arrived already; nothing: there is none.
  static std::optional<protocol::Reply> next(Client& client);
  // Ends the connection at once, without a word: the server takes the leases as lost.
  static void drop(Client& client) noexcept;
};

}  // namespace visum
