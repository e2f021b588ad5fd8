// The sending half of a session: encoded frames that wait to be written, batched into one write. Replies and
// events keep their order and are never dropped. Of each stream at most one sample waits, the newest. Owned
// by a session; no socket, no clock, not thread-safe.
//
// In each batch the samples stand before the replies. So when a client receives a reply, it has every sample
// that was queued before that reply, or a newer one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/messages.h"

namespace visum::protocol {

class WriteQueue {
 public:
  // Queues a reply, or an event if `reply_to` is 0. A frame above `max_frame` is replaced by an error.
  void push(std::uint64_t reply_to, const Reply& reply, std::size_t max_frame);
  // Queues a sample. Returns false if it replaced an unsent one of the same stream.
  bool push_latest(std::uint32_t stream, const Reply& sample, std::size_t max_frame);
  bool has_waiting(std::uint32_t stream) const;

  // The bytes to write next; empty if there are none. Once a batch is written out, all that waits becomes the
  // next one.
  std::span<const std::byte> front();
  // Tells how many bytes of front() were written.
  void written(std::size_t bytes);

  bool empty() const { return !in_flight() && waiting_.empty() && waiting_samples_ == 0; }
  bool in_flight() const { return sent_ < flying_.size(); }
  std::size_t bytes() const;  // of all that is not written yet
  // Bytes of replies and events that wait behind the batch in flight.
  std::size_t waiting_bytes() const { return waiting_.size(); }
  std::size_t waiting_replies() const { return waiting_replies_; }
  std::size_t waiting_event_bytes() const { return waiting_event_bytes_; }  // of the events among them

 private:
  struct Stream {
    std::uint32_t id;
    bool waiting;
    std::vector<std::byte> frame;
  };
  Stream& stream(std::uint32_t id);
  // Makes all that waits the batch in flight.
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
