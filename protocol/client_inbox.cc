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

ClientInbox::Place ClientInbox::find(std::uint64_t id) {
  const auto found = std::ranges::lower_bound(expected_, id, {}, &Expected::id);
  return found != expected_.end() && found->id == id ? found : expected_.end();
}

void ClientInbox::forget(std::uint64_t id) {
  if (const auto found = find(id); found != expected_.end()) expected_.erase(found);
}

bool ClientInbox::unbounded(std::uint64_t id) {
  if (const auto found = find(id); found != expected_.end()) return found->unbounded;
  throw std::invalid_argument("no request with id " + std::to_string(id) + " is in flight");
}

void ClientInbox::put(ReplyFrame frame) {
  if (frame.reply_to != 0) {
    if (const auto found = find(frame.reply_to); found != expected_.end())
      found->reply = std::move(frame.reply);
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
  const auto found = find(id);
  if (found == expected_.end() || !found->reply) return std::nullopt;
  Reply reply = std::move(*found->reply);
  expected_.erase(found);
  return reply;
}

std::optional<Reply> ClientInbox::take_next() {
  if (kept_.empty()) return std::nullopt;
  Reply reply = std::move(kept_.front());
  kept_.pop_front();
  if (!stream_of(reply)) --kept_events_;
  return reply;
}

}  // namespace visum::protocol
