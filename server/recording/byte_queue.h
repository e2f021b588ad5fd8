// A bounded queue of bytes from one thread to another, without a lock. Its memory is in blocks that are used
// again as soon as they are empty: where the taking thread keeps up, the bytes stay in the cache.
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace visum::recording {

class ByteQueue {
 public:
  static constexpr std::size_t kBlockBytes = 64u << 10;
  using Bytes = std::span<const std::byte>;

  // `capacity`: how many bytes may wait. Throws std::bad_alloc; later calls take no memory.
  explicit ByteQueue(std::size_t capacity);

  // The putting thread. Puts all pieces, one behind the other, or nothing where they do not fit (false).
  bool put(std::span<const Bytes> pieces);
  // The putting thread: how many bytes still fit.
  std::size_t room() const { return capacity_ - (put_bytes_ - taken_.load(std::memory_order_acquire)); }

  // The taking thread: how many bytes wait, in whole calls of put().
  std::size_t waiting() const { return put_.load(std::memory_order_acquire) - taken_bytes_; }
  // The taking thread. At least so many bytes must wait.
  void take(std::span<std::byte> to);

 private:
  using Blocks = boost::lockfree::spsc_queue<std::uint32_t>;

  void append(Bytes piece);
  // Asks the processor for the memory of what may be put next, so that it is there by then.
  void fetch_ahead(std::size_t bytes) const;
  std::byte* place(std::uint32_t block, std::size_t at) const {
    return memory_.get() + block * kBlockBytes + at;
  }

  const std::size_t capacity_;
  const std::size_t blocks_;
  const std::unique_ptr<std::byte[]> memory_;
  Blocks filled_, empty_;  // the numbers of blocks: in the order of their bytes; to be used again
  // The putting thread's: the block that it fills, its bytes so far, the first block that was never used, all
  // bytes ever put.
  std::uint32_t filling_ = 0, unused_ = 0;
  std::size_t filling_at_ = kBlockBytes;
  std::size_t put_bytes_ = 0;
  std::atomic<std::size_t> put_{0};
  // The taking thread's: the block that it empties, its bytes so far, all bytes ever taken.
  std::uint32_t emptying_ = 0;
  std::size_t emptying_at_ = kBlockBytes;
  std::size_t taken_bytes_ = 0;
  std::atomic<std::size_t> taken_{0};
};

}  // namespace visum::recording
