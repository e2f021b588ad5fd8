#include "protocol/frame_buffer.h"

#include <algorithm>
#include <cstring>

#include "protocol/codec.h"

namespace visum::protocol {

FrameBuffer::FrameBuffer(std::size_t initial_bytes, std::size_t idle_bytes)
    : bytes_(std::max(initial_bytes, kHeaderBytes)), idle_bytes_(std::max(idle_bytes, initial_bytes)) {}

std::span<std::byte> FrameBuffer::space() {
  if (held() == 0) {
    begin_ = end_ = 0;
    shrink_when_idle();
  }
  // If a frame does not fit behind the bytes that are there, it moves to the front. Then the buffer grows by
  // doubling as its bytes arrive.
  if (begin_ > 0 && (end_ == bytes_.size() || begin_ + wanted_ > bytes_.size())) compact();
  if (end_ == bytes_.size()) bytes_.resize(std::max(std::min(wanted_, 2 * bytes_.size()), bytes_.size() + 1));
  return {bytes_.data() + end_, bytes_.size() - end_};
}

void FrameBuffer::commit(std::size_t bytes) {
  end_ += bytes;
}

FrameBuffer::Next FrameBuffer::next(std::size_t max_payload) {
  wanted_ = 0;
  if (held() == 0) return {};
  if (held() < kHeaderBytes) return {State::kPartial, {}, 0};
  const std::uint32_t length =
      frame_length(std::span<const std::byte, kHeaderBytes>(bytes_.data() + begin_, kHeaderBytes));
  if (length > max_payload) return {State::kTooLarge, {}, length};
  wanted_ = kHeaderBytes + length;
  if (held() < wanted_) return {State::kPartial, {}, length};
  const Next frame{State::kFrame, {bytes_.data() + begin_ + kHeaderBytes, length}, length};
  begin_ += wanted_;
  wanted_ = 0;
  return frame;
}

void FrameBuffer::reserve(std::size_t bytes) {
  if (bytes_.size() < bytes) bytes_.resize(bytes);
  idle_bytes_ = std::max(idle_bytes_, bytes);
}

void FrameBuffer::clear() {
  begin_ = end_ = wanted_ = 0;
}

void FrameBuffer::give_up() {
  clear();
  bytes_ = std::vector<std::byte>(kHeaderBytes);
}

void FrameBuffer::compact() {
  std::memmove(bytes_.data(), bytes_.data() + begin_, held());
  end_ -= begin_;
  begin_ = 0;
}

void FrameBuffer::shrink_when_idle() {
  if (bytes_.size() <= idle_bytes_) return;
  bytes_.resize(idle_bytes_);
  bytes_.shrink_to_fit();
}

}  // namespace visum::protocol
