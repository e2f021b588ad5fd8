#include "server/recording/byte_queue.h"

#include <algorithm>
#include <cstring>

namespace visum::recording {

// The first and the last of the blocks that hold waiting bytes may hold others, too.
ByteQueue::ByteQueue(std::size_t capacity)
    : capacity_(capacity),
      blocks_(capacity / kBlockBytes + 2),
      memory_(std::make_unique_for_overwrite<std::byte[]>(blocks_ * kBlockBytes)),
      filled_(blocks_),
      empty_(blocks_) {}

bool ByteQueue::put(std::span<const Bytes> pieces) {
  std::size_t size = 0;
  for (const auto piece : pieces) size += piece.size();
  if (size > room()) return false;
  for (const auto piece : pieces) append(piece);
  put_bytes_ += size;
  put_.store(put_bytes_, std::memory_order_release);
  fetch_ahead(size);
  return true;
}

// The taking thread read this block last, on another processor.
void ByteQueue::fetch_ahead(std::size_t bytes) const {
  constexpr std::size_t kCacheLine = 64;
  constexpr int kToWrite = 1;
  const std::size_t end = std::min(filling_at_ + bytes, kBlockBytes);
  for (std::size_t at = filling_at_; at < end; at += kCacheLine)
    __builtin_prefetch(place(filling_, at), kToWrite);
}

void ByteQueue::append(Bytes piece) {
  while (!piece.empty()) {
    if (filling_at_ == kBlockBytes) {
      if (!empty_.pop(filling_)) filling_ = unused_++;
      filled_.push(filling_);
      filling_at_ = 0;
    }
    const auto size = std::min(piece.size(), kBlockBytes - filling_at_);
    std::memcpy(place(filling_, filling_at_), piece.data(), size);
    filling_at_ += size;
    piece = piece.subspan(size);
  }
}

// A block is empty before taken_ says so: whoever sees the room finds the block.
void ByteQueue::take(std::span<std::byte> to) {
  taken_bytes_ += to.size();
  while (!to.empty()) {
    if (emptying_at_ == kBlockBytes) {
      filled_.pop(emptying_);
      emptying_at_ = 0;
    }
    const auto size = std::min(to.size(), kBlockBytes - emptying_at_);
    std::memcpy(to.data(), place(emptying_, emptying_at_), size);
    emptying_at_ += size;
    to = to.subspan(size);
    if (emptying_at_ == kBlockBytes) empty_.push(emptying_);
  }
  taken_.store(taken_bytes_, std::memory_order_release);
}

}  // namespace visum::recording
