// The receiving half of the framing: bytes go in as they arrive, whole payloads come out. No socket, no
// clock, not thread-safe. Memory grows as bytes arrive, never by what a header merely announces.
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
    std::span<const std::byte> payload;  // kFrame; valid until space() or clear()
    std::uint32_t length = 0;            // as announced; kFrame and kTooLarge
  };

  // `initial_bytes` at first; up to `idle_bytes` are kept between frames.
  FrameBuffer(std::size_t initial_bytes, std::size_t idle_bytes);

  // Where to receive into (never empty), and how much of it was filled.
  std::span<std::byte> space();
  void commit(std::size_t bytes);

  // Takes the next frame out. A frame over `max_payload` is kTooLarge as soon as its header is there.
  Next next(std::size_t max_payload);

  // Room for at least so many bytes, so that one read can bring many frames.
  void reserve(std::size_t bytes);
  void clear();

 private:
  std::size_t held() const { return end_ - begin_; }
  void compact();
  void shrink_when_idle();

  std::vector<std::byte> bytes_;
  std::size_t begin_ = 0, end_ = 0;
  std::size_t wanted_ = 0;  // bytes of the frame at begin_, header included; 0: not known yet
  std::size_t idle_bytes_;
};

}  // namespace visum::protocol
