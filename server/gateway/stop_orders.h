// The server's side of an emergency stop by datagrams: which are obeyed, and how each is answered. It knows
// no socket, so that a test can hand it any bytes.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "protocol/stop_datagram.h"
#include "server/gateway/access.h"
#include "server/gateway/stop_latch.h"

namespace visum::gateway {

// Lives on the door's thread. Keeps nothing of a client before its order is good, so that strangers cannot
// fill it. Nothing that it is handed makes it throw or log.
class StopOrders {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMost = 64;                 // orders that wait, and orders that are remembered
  static constexpr std::chrono::seconds kCookieSlice{10};  // a cookie is good for one to two of them
  static constexpr std::chrono::seconds kPatience{30};     // an order that waits longer gets no answer

  // `sessions_only`: clients show certificates, which datagrams cannot. The references must outlive it.
  // `parts`: names by number in the latch; empty: none.
  StopOrders(std::vector<std::string> parts, const Tokens& tokens, bool sessions_only, StopLatch& latch);

  // The answer to a datagram of `peer`, which is the address in any form; nothing: none is due.
  std::optional<protocol::StopDatagram> answer(std::span<const std::byte> datagram, const std::string& peer,
                                               Clock::time_point now);
  // Other parts are there from now on.
  void set_parts(std::vector<std::string> parts) { parts_ = std::move(parts); }
  bool waits() const { return !waiting_.empty(); }
  // The answers to orders that have acted since the last call, each with its peer.
  std::vector<std::pair<std::string, protocol::StopDatagram>> acted(Clock::time_point now);

 private:
  struct Order {
    std::string peer;
    protocol::StopNonce nonce{};
    std::uint64_t ticket = 0;
    Clock::time_point since;
    std::int64_t tick = 0;  // once it has acted
  };

  protocol::KeyedHash cookie_of(const std::string& peer, const protocol::StopNonce& nonce,
                                std::int64_t slice) const;
  std::optional<protocol::StopRefusal> refuse(const protocol::StopOrder& order, const std::string& peer,
                                              Clock::time_point now) const;
  protocol::StopDatagram obey(const protocol::StopOrder& order, const std::string& peer,
                              Clock::time_point now);

  std::vector<std::string> parts_;
  const Tokens& tokens_;
  const protocol::StopProof proof_;
  StopLatch& latch_;
  protocol::KeyedHash secret_{};
  std::deque<Order> waiting_, done_;  // an order that is repeated is not obeyed again
};

}  // namespace visum::gateway
