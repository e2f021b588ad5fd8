// Commands on their way: requests that the tick's thread answers between two ticks.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/gateway/call.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/parts.h"

namespace visum::gateway {

// Lives on the sessions' thread, owned by the Gateway. TimeControl, PartSettings and WorldRequests send
// through it; the Gateway takes back what was answered and replies.
class Commands {
 public:
  Commands(Mailbox& mailbox, Parts& parts) : mailbox_(mailbox), parts_(parts) {}

  // Sends the call's request, after all that was written before it. The client waits from now on. Where there
  // is no room the call fails with kBusy. `part`: where the request is about one.
  void send(const Call& call, const protocol::Request& request, std::uint32_t part = 0);

  // Collects what was answered. To be called before the newest copy of the world is taken: then that copy is
  // at least as new as the answers, and requests behind these commands are answered from it.
  void collect();
  // Hands out the collected commands, for their replies.
  std::vector<std::unique_ptr<Command>> take_collected();

 private:
  Mailbox& mailbox_;
  Parts& parts_;
  std::vector<std::unique_ptr<Command>> done_;
};

}  // namespace visum::gateway
