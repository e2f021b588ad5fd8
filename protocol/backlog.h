// The requests of a session that wait behind one, in the order in which they came. Their number and their
// bytes are bounded, since a client may send faster than the world goes on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "protocol/messages.h"

namespace visum::protocol {

// Used on the thread of the sessions, and owned by the class that handles the requests.
class Backlog {
 public:
  static constexpr std::size_t kMost = 64;              // requests
  static constexpr std::size_t kMostBytes = 32u << 20;  // of their frames: two of the largest of an admin

  struct Entry {
    std::uint64_t id = 0;
    Request request;
    std::size_t bytes = 0;  // of its frame
  };

  bool empty() const { return entries_.empty(); }
  const Entry& front() const { return entries_.front(); }

  // Why a request of so many bytes finds no place at the end; empty: it finds one.
  std::string refuse(std::size_t bytes) const {
    if (entries_.size() >= kMost)
      return "too many requests behind one that waits: at most " + std::to_string(kMost) + " wait there";
    if (bytes_ + bytes > kMostBytes)
      return "a request of " + std::to_string(bytes) + " bytes has no room behind one that waits: at most " +
             std::to_string(kMostBytes >> 20) + " MiB wait there, and " + std::to_string(bytes_) +
             " bytes do already";
    return {};
  }

  // The caller has asked refuse().
  void push(Entry entry) {
    bytes_ += entry.bytes;
    entries_.push_back(std::move(entry));
  }
  // Back to the front, for one that was just taken from there, or came while nothing waited.
  void put_first(Entry entry) {
    bytes_ += entry.bytes;
    entries_.push_front(std::move(entry));
  }
  Entry take() {
    Entry first = std::move(entries_.front());
    entries_.pop_front();
    bytes_ -= first.bytes;
    return first;
  }

 private:
  std::deque<Entry> entries_;
  std::size_t bytes_ = 0;  // of all
};

}  // namespace visum::protocol
