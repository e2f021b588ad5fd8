#include "protocol/client_inbox.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace visum::protocol {
namespace {

// The stream that a sample belongs to: "part NAME" or "world". Nothing if the reply is no sample.
std::optional<std::string> stream_of(const Reply& reply) {
  if (const auto* part = std::get_if<PartSample>(&reply)) return "part " + part->part;
  if (std::holds_alternative<WorldSample>(reply)) return "world";
  return std::nullopt;
}

std::uint64_t& conflated_of(Reply& sample) {
  if (auto* part = std::get_if<PartSample>(&sample)) return part->conflated;
  return std::get<WorldSample>(sample).conflated;
}

}  // namespace

void ClientInbox::expect(std::uint64_t id, bool unbounded) {
  expected_.push_back({id, unbounded, std::nullopt});
}

void ClientInbox::forget(std::uint64_t id) {
  std::erase_if(expected_, [id](const Expected& entry) { return entry.id == id; });
}

bool ClientInbox::unbounded(std::uint64_t id) const {
  for (const Expected& entry : expected_)
    if (entry.id == id) return entry.unbounded;
  throw std::invalid_argument("no request with id " + std::to_string(id) + " is in flight");
}

void ClientInbox::put(ReplyFrame frame) {
  if (frame.reply_to != 0) {
    for (Expected& entry : expected_)
      if (entry.id == frame.reply_to) entry.reply = std::move(frame.reply);
    return;
  }
  if (const auto* error = std::get_if<Error>(&frame.reply)) last_error_ = error->text;
  keep(std::move(frame.reply));
}

void ClientInbox::keep(Reply reply) {
  if (const auto stream = stream_of(reply)) {
    replace_sample(*stream, reply);
  } else if (kept_events_ == kMaxKeptEvents) {
    kept_.erase(std::find_if(kept_.begin(), kept_.end(), [](const Reply& kept) { return !stream_of(kept); }));
  } else {
    ++kept_events_;
  }
  kept_.push_back(std::move(reply));
}

void ClientInbox::replace_sample(const std::string& stream, Reply& sample) {
  std::uint64_t& dropped = dropped_[stream];
  dropped += std::erase_if(kept_, [&](const Reply& kept) { return stream_of(kept) == stream; });
  conflated_of(sample) += dropped;
}

std::optional<Reply> ClientInbox::take_reply(std::uint64_t id) {
  for (Expected& entry : expected_) {
    if (entry.id != id || !entry.reply) continue;
    Reply reply = std::move(*entry.reply);
    forget(id);
    return reply;
  }
  return std::nullopt;
}

std::optional<Reply> ClientInbox::take_next() {
  if (kept_.empty()) return std::nullopt;
  Reply reply = std::move(kept_.front());
  kept_.pop_front();
  if (!stream_of(reply)) --kept_events_;
  return reply;
}

}  // namespace visum::protocol
