// The receiving half of the framing: bytes go in as they arrive, whole payloads come out. Each session and
// each client's connection owns one; it is not thread-safe and knows no socket and no clock. Its memory grows
// with the bytes that arrive, never by the length that a header announces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace visum::protocol {

class FrameBuffer {
 public:
  enum class State { kEmpty, kPartial, kFrame, kTooLarge };
  struct Next {
    State state = State::kEmpty;
    std::span<const std::byte> payload;  // for kFrame; valid until space() or clear()
    std::uint32_t length = 0;            // as announced; for kFrame and kTooLarge
  };

  // Starts with `initial_bytes` of memory. Keeps up to `idle_bytes` between frames.
  FrameBuffer(std::size_t initial_bytes, std::size_t idle_bytes);

  // Where to receive into; never empty. Call commit() with the number of bytes that were received.
  std::span<std::byte> space();
  void commit(std::size_t bytes);

  // Takes the next frame out. A frame larger than `max_payload` is kTooLarge as soon as its header has
  // arrived.
  Next next(std::size_t max_payload);

  // Makes room for at least so many bytes, so that one read can bring many frames.
  void reserve(std::size_t bytes);
  void clear();
  // Drops what is held, and the memory with it.
  void give_up();

 private:
  std::size_t held() const { return end_ - begin_; }
  // Moves the held bytes to the front of the buffer.
  void compact();
  // Gives memory above `idle_bytes` back. Call only when nothing is held.
  void shrink_when_idle();

  std::vector<std::byte> bytes_;
  std::size_t begin_ = 0, end_ = 0;
  std::size_t wanted_ = 0;  // bytes of the frame at begin_, header included; 0: not known yet
  std::size_t idle_bytes_;
};

}  // namespace visum::protocol
