// A session without a socket. The test feeds it with bytes; what it writes is counted and thrown away. For
// tests and the fuzzer.
#pragma once

#include <algorithm>
#include <span>

#include "protocol/session_core.h"

namespace visum::testing {

class MemorySession final : public protocol::SessionCore {
 public:
  explicit MemorySession(protocol::SessionContext& context) : SessionCore(context, 1, "memory") {}

  // Passes the bytes in one piece, or in several if the session's buffer is smaller.
  void feed(std::span<const std::byte> bytes) {
    while (!bytes.empty() && !closing()) {
      const auto space = in().space();
      const std::size_t count = std::min(space.size(), bytes.size());
      std::copy_n(bytes.begin(), count, space.begin());
      in().commit(count);
      bytes = bytes.subspan(count);
      while (handle_frames() == Appetite::kTurn) flush();
    }
    flush();
    tell_room();
    tell_closed();
  }
  void end() {
    peer_closed();
    tell_closed();
  }
  void sweep() {
    check_deadlines();
    tell_closed();
  }
  std::size_t bytes_written() const { return written_; }

 private:
  void wake() override {}
  void flush() override {
    while (!out().empty()) {
      const std::size_t bytes = out().front().size();
      out().written(bytes);
      written_ += bytes;
    }
  }

  std::size_t written_ = 0;
};

}  // namespace visum::testing
