#include "protocol/write_queue.h"

#include <algorithm>
#include <string>
#include <utility>

#include "protocol/codec.h"

namespace visum::protocol {
namespace {

constexpr std::size_t kKeepBytes = 256u << 10;  // larger buffers are freed once they are empty

void empty_out(std::vector<std::byte>& buffer) {
  if (buffer.capacity() > kKeepBytes) buffer = {};
  buffer.clear();
}

// A client would close the connection over a frame above its limit, so it gets an error instead.
void encode_within(std::uint64_t reply_to, const Reply& reply, std::size_t max_frame,
                   std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  encode_reply(reply_to, reply, out);
  const std::size_t length = out.size() - start - kHeaderBytes;
  if (length <= max_frame) return;
  out.resize(start);
  encode_reply(reply_to,
               Error{ErrorCode::kTooLarge,
                     "the answer has " + std::to_string(length) + " bytes, over the limit of " +
                         std::to_string(max_frame),
                     {}},
               out);
}

}  // namespace

void WriteQueue::push(std::uint64_t reply_to, const Reply& reply, std::size_t max_frame) {
  const std::size_t before = waiting_.size();
  encode_within(reply_to, reply, max_frame, waiting_);
  ++waiting_replies_;
  if (reply_to == 0) waiting_event_bytes_ += waiting_.size() - before;
}

bool WriteQueue::push_latest(std::uint32_t id, const Reply& sample, std::size_t max_frame) {
  Stream& to = stream(id);
  const bool replaced = to.waiting;
  to.frame.clear();
  encode_within(0, sample, max_frame, to.frame);
  to.waiting = true;
  if (!replaced) ++waiting_samples_;
  return !replaced;
}

bool WriteQueue::has_waiting(std::uint32_t id) const {
  return std::any_of(streams_.begin(), streams_.end(),
                     [id](const Stream& stream) { return stream.id == id && stream.waiting; });
}

std::size_t WriteQueue::bytes() const {
  std::size_t bytes = flying_.size() - sent_ + waiting_.size();
  for (const Stream& stream : streams_)
    if (stream.waiting) bytes += stream.frame.size();
  return bytes;
}

std::span<const std::byte> WriteQueue::front() {
  if (!in_flight()) take_off();
  return std::span<const std::byte>(flying_).subspan(sent_);
}

void WriteQueue::written(std::size_t bytes) {
  sent_ += bytes;
}

WriteQueue::Stream& WriteQueue::stream(std::uint32_t id) {
  const auto found =
      std::find_if(streams_.begin(), streams_.end(), [id](const Stream& stream) { return stream.id == id; });
  if (found != streams_.end()) return *found;
  return streams_.emplace_back(Stream{id, false, {}});
}

void WriteQueue::take_off() {
  empty_out(flying_);
  sent_ = 0;
  if (waiting_samples_ > 0) {
    for (Stream& stream : streams_) {
      if (!stream.waiting) continue;
      flying_.insert(flying_.end(), stream.frame.begin(), stream.frame.end());
      stream.waiting = false;
    }
    flying_.insert(flying_.end(), waiting_.begin(), waiting_.end());
    empty_out(waiting_);
    waiting_samples_ = 0;
  } else {
    std::swap(flying_, waiting_);
  }
  waiting_replies_ = 0;
  waiting_event_bytes_ = 0;
}

}  // namespace visum::protocol
