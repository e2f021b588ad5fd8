// How far the peer of a WebSocket session is behind: what was sent, and up to where its pongs say that it
// reads. A page that does not run (asleep, or on a busy machine) is sent no more than a window, which the
// kernel's buffers hold: so it is not taken for a dead peer, and finds the present when it wakes. Pure.
#pragma once

#include <cstddef>
#include <cstdint>

namespace visum::protocol {

class ReadingWindow {
 public:
  static constexpr std::size_t kBytes = 32u << 10;  // unread, and one piece more may be sent
  static constexpr std::size_t kPiece = 16u << 10;  // sent at a time

  bool open() const { return sent_ - read_ < kBytes; }
  // Half of the window is out, and no ping is on its way.
  bool ping_due() const { return !pinged_ && sent_ - read_ >= kBytes / 2; }
  void sent(std::size_t bytes) { sent_ += bytes; }
  void ping_sent() {
    pinged_ = true;
    ping_at_ = sent_;
  }
  // Pongs come in the order of what was sent: whatever stood before the ping is read.
  void pong_came() {
    if (!pinged_) return;
    pinged_ = false;
    read_ = ping_at_;
  }

 private:
  std::uint64_t sent_ = 0, read_ = 0, ping_at_ = 0;  // bytes since the start
  bool pinged_ = false;
};

}  // namespace visum::protocol
