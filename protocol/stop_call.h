// The client's end of an emergency stop by datagrams (stop_datagram.h). It needs no session, so that nothing
// that holds up the server's sessions delays it. Blocks the thread that calls it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "protocol/stop_datagram.h"

namespace visum::protocol {

struct StopNews {
  enum class State {
    kSilent,    // no answer yet
    kAnswered,  // the server is there
    kLatched,   // it has the order; the parts stop at the end of the tick that it is in
    kActed,     // the parts have stopped
    kRefused
  };
  State state = State::kSilent;
  std::int64_t tick = 0;                       // kActed: the border at which they stopped
  StopRefusal refusal = StopRefusal::kCookie;  // kRefused
};

// Orders the stop until it has acted, is refused, `at_most` is over, or `end` is asked for; returns how far
// it came. `part` empty: all parts. `token`: one of the server's tokens; empty: none. `on_news` is called
// with each step forward. Throws ConnectionError where the host is unknown.
StopNews call_stop(const std::string& host, std::uint16_t port, const std::string& part,
                   const std::string& token, std::chrono::milliseconds at_most,
                   const std::function<void(const StopNews&)>& on_news, const std::stop_token& end = {});

}  // namespace visum::protocol
