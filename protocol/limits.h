// Named maxima of the protocol (reliability.md §3, "Our limit"). Checked before anything is allocated.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace visum::protocol {

inline constexpr std::uint32_t kProtocolVersion = 1;
inline constexpr std::uint16_t kDefaultPort = 1500;

struct Limits {
  std::size_t max_frame = 64u << 10;  // a request's payload
  std::size_t max_frame_before_hello = 1u << 10;
  std::size_t max_frame_admin = 16u << 20;         // AddBody, role admin only
  std::size_t max_frame_to_client = 64u << 20;     // what a client accepts
  int max_depth = 16;                              // protobuf nesting
  std::chrono::milliseconds hello_deadline{2000};  // the whole message, not per read
  std::chrono::milliseconds frame_deadline{1000};  // from a frame's first byte to its last
  std::chrono::milliseconds stall_deadline{2000};  // a writer without progress is closed
  std::size_t max_sessions = 512;
  std::size_t max_unauthenticated = 32;
  std::size_t max_sessions_per_peer = 128;    // loopback exempt
  double accepts_per_second = 200.0;          // token bucket; delays, never refuses
  std::size_t max_queued_replies = 1024;      // per session; more: close
  std::size_t max_queued_bytes = 256u << 10;  // of replies and events, beyond the one being written
};

}  // namespace visum::protocol
