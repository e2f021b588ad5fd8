// One direction of a connection as TCP gives it: bytes come in order and whole, but late, in pieces of any
// size, and for a while not at all. Times in simulated milliseconds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "tests/gateway/storm/dice.h"

namespace visum::storm {

class Wire {
 public:
  explicit Wire(Dice& dice) : dice_(dice), slowness_ms_(dice.one_in(3) ? dice.within(1, 40) : 0) {}

  std::size_t room() const { return kWindowBytes - held_; }
  // At most room() bytes.
  void put(std::span<const std::byte> bytes, std::int64_t now_ms) {
    held_ += bytes.size();
    const std::int64_t late = now_ms + dice_.within(0, slowness_ms_);
    last_due_ms_ = std::max(last_due_ms_, late);
    for (std::byte byte : bytes) pieces_.push_back({last_due_ms_, byte});
  }
  // Fills what has arrived by now into `space`, now and then only a part of it; how many bytes that were.
  std::size_t take(std::span<std::byte> space, std::int64_t now_ms) {
    if (now_ms < clogged_until_ms_) return 0;
    std::size_t most = space.size();
    if (dice_.one_in(4)) most = std::min(most, dice_.below(64));
    std::size_t count = 0;
    for (; count < most && !pieces_.empty() && pieces_.front().due_ms <= now_ms; ++count) {
      space[count] = pieces_.front().byte;
      pieces_.pop_front();
    }
    held_ -= count;
    return count;
  }
  bool empty() const { return pieces_.empty(); }
  void clog(std::int64_t until_ms) { clogged_until_ms_ = until_ms; }

 private:
  static constexpr std::size_t kWindowBytes = 16 << 10;  // what the kernels of both sides hold
  struct Piece {
    std::int64_t due_ms;
    std::byte byte;
  };
  Dice& dice_;
  const std::int64_t slowness_ms_;
  std::deque<Piece> pieces_;
  std::size_t held_ = 0;
  std::int64_t last_due_ms_ = 0;
  std::int64_t clogged_until_ms_ = 0;
};

// Both directions, and whether the connection still stands.
struct Connection {
  explicit Connection(Dice& dice) : to_server(dice), to_client(dice) {}
  Wire to_server, to_client;
  bool client_left = false;    // closed its side: the server reads the rest, then the end of the stream
  bool reset = false;          // by either side: nothing passes any more
  bool server_closed = false;  // the client reads the rest, then the end of the stream
};

}  // namespace visum::storm
