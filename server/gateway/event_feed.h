// The events of a server: the newest are kept, and those that are only for subscribers are limited in number.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

#include "protocol/messages.h"
#include "protocol/token_bucket.h"

namespace visum::gateway {

// Lives on the sessions' thread, owned by Clients, which sends the events.
class EventFeed {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMostKept = 1000;
  static constexpr std::size_t kMostBytes = 1000;  // of a text; the rest is cut off
  static constexpr double kMostPerSecond = 100.0;  // that are for subscribers only; with bursts of as many

  // Counts its time from here on.
  void start(Clock::time_point now) { bucket_ = {kMostPerSecond, now}; }
  // True: there is room for one more event now. False: it is counted as lost.
  bool has_room(Clock::time_point now);
  // How many were lost since the last call; 0 while more are lost.
  std::uint64_t take_lost(Clock::time_point now);
  // Completes an event (level, source, time) and keeps it.
  void keep(protocol::Event& event);
  // The kept ones of at least this level, oldest first.
  protocol::EventList kept(protocol::EventLevel least) const;

  void set_world(std::int64_t tick_ns, const std::string& program) {
    tick_ns_ = tick_ns;
    program_ = program;
  }

 private:
  std::deque<protocol::Event> kept_;
  protocol::TokenBucket bucket_{kMostPerSecond, Clock::now()};
  std::uint64_t lost_ = 0;
  std::int64_t tick_ns_ = 0;
  std::string program_;
};

}  // namespace visum::gateway
