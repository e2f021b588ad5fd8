// Tracks how far the peer of a WebSocket session is behind: how many bytes were sent, and how many of them
// its pongs confirm as read. A page that does not run (asleep, or on a busy machine) is sent no more than one
// window, which fits into the kernel's buffers. So it is not taken for a dead peer, and it gets current
// samples when it wakes. Owned by one session, used on its thread; no socket, no clock.
#pragma once

#include <cstddef>
#include <cstdint>

namespace visum::protocol {

class ReadingWindow {
 public:
  static constexpr std::size_t kBytes = 32u << 10;  // may be sent unread; one more piece may follow
  static constexpr std::size_t kPiece = 16u << 10;  // sent at a time

  bool open() const { return sent_ - read_ < kBytes; }
  // True when half of the window is unread and no ping is on its way.
  bool ping_due() const { return !pinged_ && sent_ - read_ >= kBytes / 2; }
  void sent(std::size_t bytes) { sent_ += bytes; }
  void ping_sent() {
    pinged_ = true;
    ping_at_ = sent_;
  }
  // A pong confirms all that was sent before its ping, because the peer reads in order.
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
