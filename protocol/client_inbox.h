// What arrived at a client and was not fetched yet: replies to requests in flight, and samples and events in
// the order of their arrival. Bounded: of each stream only the newest sample is kept, of events and late
// errors the newest 1024. No socket, not thread-safe.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/codec.h"

namespace visum::protocol {

inline constexpr std::size_t kMaxKeptEvents = 1024;

class ClientInbox {
 public:
  // A reply to `id` is wanted from now on. Replies that nobody wants (any more) are dropped.
  void expect(std::uint64_t id, bool unbounded);
  void forget(std::uint64_t id);
  // Whether waiting for it has no time limit, as the caller of expect() said. Throws std::invalid_argument
  // where it is not expected.
  bool unbounded(std::uint64_t id) const;

  void put(ReplyFrame frame);

  std::optional<Reply> take_reply(std::uint64_t id);
  std::optional<Reply> take_next();  // the oldest sample, event, or error that answers no request

  // The text of the last error that answered no request: why the server hung up, most likely.
  const std::string& last_error() const { return last_error_; }

 private:
  struct Expected {
    std::uint64_t id;
    bool unbounded;
    std::optional<Reply> reply;
  };
  void keep(Reply reply);
  void replace_sample(const std::string& stream, Reply& sample);

  std::vector<Expected> expected_;  // few
  std::deque<Reply> kept_;
  std::size_t kept_events_ = 0;
  std::map<std::string, std::uint64_t>
      dropped_;  // samples dropped here, by stream; see the sample's `conflated`
  std::string last_error_;
};

}  // namespace visum::protocol
