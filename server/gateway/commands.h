// Commands on their way: requests that the tick's thread answers between two ticks.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/gateway/call.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/parts.h"
#include "server/gateway/stop_latch.h"

namespace visum::gateway {

// Lives on the sessions' thread, owned by the Gateway. TimeControl, PartSettings and WorldRequests send
// through it; the Gateway takes back what was answered and replies.
//
// A tick may take long. A Pause, or an emergency stop, that has waited for kPatience is therefore
// acknowledged before it is done: it is latched, and acts at the end of that tick.
class Commands {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kPatience{200};

  Commands(Mailbox& mailbox, Parts& parts, StopLatch& stops)
      : mailbox_(mailbox), parts_(parts), stops_(stops) {}

  // Sends the call's request, after all that was written before it. The client waits from now on. Where there
  // is no room the call fails with kBusy. `part`: where the request is about one.
  void send(const Call& call, const protocol::Request& request, std::uint32_t part = 0,
            std::vector<protocol::WriteBlackboard> pieces = {});

  // Stops the part. The client waits until that has acted. Nothing that waits elsewhere delays it.
  void stop(const Call& call, std::uint32_t part);
  // Presses the stop alone, for a request whose turn has not come yet.
  void press(std::uint32_t part) { stops_.press(part); }

  // Collects what was answered. To be called before the newest copy of the world is taken: then that copy is
  // at least as new as the answers, and requests behind these commands are answered from it.
  void collect();
  // Hands out the collected commands, for their replies.
  std::vector<std::unique_ptr<Command>> take_collected();
  // Acknowledges what has waited for kPatience by `now`, in the tick that began at `border`. Those clients
  // wait no longer. False: there was none.
  bool acknowledge_late(Clients& clients, std::int64_t border, Clock::time_point now);

 private:
  // A Pause or an emergency stop that may have to be acknowledged.
  struct Latched {
    std::uint64_t session = 0;
    std::uint64_t id = 0;
    Clock::time_point since;
    Command* pause = nullptr;  // in the mailbox; only its address is used. Null: a stop
    std::uint64_t ticket = 0;  // of the stop
    bool acknowledged = false;
  };

  Mailbox& mailbox_;
  Parts& parts_;
  StopLatch& stops_;
  std::vector<Latched> latched_;
  std::vector<std::unique_ptr<Command>> done_;
};

}  // namespace visum::gateway
