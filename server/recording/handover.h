// Hands bytes from one thread to another, without a lock. Whoever puts appends to a buffer; whoever takes
// swaps it for an empty one. So only as much memory is touched as one round fills, and it stays in the cache.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

namespace visum::recording {

class Handover {
 public:
  using Bytes = std::span<const std::byte>;

  // `capacity`: how many bytes may wait. Throws std::bad_alloc; later calls take no memory.
  explicit Handover(std::size_t capacity) : capacity_(capacity) {
    for (auto& buffer : buffers_) buffer.reserve(capacity);
  }

  // The putting thread: appends both, or nothing where there is no room (false). Never waits.
  bool put(Bytes head, Bytes body) {
    auto* const buffer = filling_.exchange(nullptr, std::memory_order_acquire);
    const bool fits = capacity_ - buffer->size() >= head.size() + body.size();
    if (fits) {
      buffer->insert(buffer->end(), head.begin(), head.end());
      buffer->insert(buffer->end(), body.begin(), body.end());
    }
    waiting_ = buffer->size();
    filling_.store(buffer, std::memory_order_release);
    return fits;
  }

  // The putting thread: how many bytes still fit for certain.
  std::size_t room() const { return capacity_ - waiting_; }

  // The taking thread: all that waits, valid until the next call. Empty where nothing waits, or where the
  // other thread is putting just now; what it puts waits for the next call.
  Bytes take() {
    auto* buffer = filling_.load(std::memory_order_relaxed);
    taken_->clear();
    if (!buffer || !filling_.compare_exchange_strong(buffer, taken_, std::memory_order_acq_rel)) return {};
    taken_ = buffer;
    return *taken_;
  }

 private:
  using Buffer = std::vector<std::byte>;
  const std::size_t capacity_;
  std::array<Buffer, 2> buffers_;
  std::atomic<Buffer*> filling_{&buffers_[0]};  // null while the putting thread appends to it
  Buffer* taken_ = &buffers_[1];                // the taking thread's
  std::size_t waiting_ = 0;                     // the putting thread's: bytes in its buffer at its last look
};

}  // namespace visum::recording
