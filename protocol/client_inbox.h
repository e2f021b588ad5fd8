// Keeps what arrived at a client until the client fetches it: replies to requests in flight, and samples and
// events in the order of their arrival. Memory is bounded: the newest sample of each stream is kept, and the
// newest 1024 events and late errors. Owned by a Connection (client.cc). Not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "protocol/codec.h"

namespace visum::protocol {

inline constexpr std::size_t kMaxKeptEvents = 1024;

class ClientInbox {
 public:
  // Announces that a reply to `id` is wanted; each id is greater than those before. A reply that is not
  // wanted, or no longer, is dropped.
  // `unbounded`: its wait has no time limit.
  void expect(std::uint64_t id, bool unbounded);
  // Gives up waiting for the reply to `id`.
  void forget(std::uint64_t id);
  // True if the wait for this reply has no time limit, as told to expect(). Throws std::invalid_argument if
  // `id` is not expected.
  bool unbounded(std::uint64_t id);

  // Files a frame that arrived: as the reply to its request, or as a sample or event.
  void put(ReplyFrame frame);

  std::optional<Reply> take_reply(std::uint64_t id);
  std::optional<Reply> take_next();  // the oldest sample, event, or error that answers no request

  // The text of the last error that answered no request. It most likely says why the server hung up.
  const std::string& last_error() const { return last_error_; }

 private:
  struct Expected {
    std::uint64_t id;
    bool unbounded;
    std::optional<Reply> reply;
  };
  using Place = std::deque<Expected>::iterator;
  void keep(Reply reply);
  void replace_sample(const std::string& stream, Reply& sample);

  // Where it stands in expected_; its end: it is not expected.
  Place find(std::uint64_t id);

  // By id. A client that sends many requests ahead takes the replies in their order, from the front.
  std::deque<Expected> expected_;
  std::deque<Reply> kept_;
  std::size_t kept_events_ = 0;
  std::map<std::string, std::uint64_t>
      dropped_;  // samples dropped here, by stream; added to `conflated` of those that follow
  std::string last_error_;
};

}  // namespace visum::protocol
