// The sending half of a session: what waits to be written, as encoded frames, batched into one write. Replies
// and events keep their order and are never dropped; of each stream at most one sample waits, the newest. No
// socket, no clock, not thread-safe.
//
// Order: in each batch the samples stand before the replies. So when a reply is there, every sample that was
// queued before it is there too, or a newer one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/messages.h"

namespace visum::protocol {

class WriteQueue {
 public:
  void push(std::uint64_t reply_to, const Reply& reply, std::size_t max_frame);
  // Returns false where an unsent sample of this stream was replaced.
  bool push_latest(std::uint32_t stream, const Reply& sample, std::size_t max_frame);
  bool has_waiting(std::uint32_t stream) const;

  // The bytes to write next; empty if there are none. What was waiting becomes the batch in flight when the
  // one before is written out.
  std::span<const std::byte> front();
  void written(std::size_t bytes);

  bool empty() const { return !in_flight() && waiting_.empty() && waiting_samples_ == 0; }
  bool in_flight() const { return sent_ < flying_.size(); }
  // Replies and events beyond the batch in flight.
  std::size_t waiting_bytes() const { return waiting_.size(); }
  std::size_t waiting_replies() const { return waiting_replies_; }
  std::size_t waiting_event_bytes() const { return waiting_event_bytes_; }  // of those with `reply_to` 0

 private:
  struct Stream {
    std::uint32_t id;
    bool waiting;
    std::vector<std::byte> frame;
  };
  Stream& stream(std::uint32_t id);
  void take_off();

  std::vector<std::byte> waiting_;
  std::size_t waiting_replies_ = 0;
  std::size_t waiting_event_bytes_ = 0;
  std::vector<Stream> streams_;  // few: one per subscription
  std::size_t waiting_samples_ = 0;
  std::vector<std::byte> flying_;
  std::size_t sent_ = 0;
};

}  // namespace visum::protocol
