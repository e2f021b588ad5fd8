// The protocol's maxima, each with a name. They are checked before memory is allocated.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace visum::protocol {

inline constexpr std::uint32_t kProtocolVersion = 1;
inline constexpr std::uint16_t kDefaultPort = 1500;

// The server's limits. SPEC.md, section 1, lists what happens when one is exceeded.
struct Limits {
  std::size_t max_frame = 64u << 10;  // payload of a request
  std::size_t max_frame_before_hello = 1u << 10;
  std::size_t max_frame_admin = 16u << 20;         // payload of an admin's request (AddBody carries YAML)
  std::size_t max_frame_to_client = 64u << 20;     // payload that a client accepts
  int max_depth = 16;                              // how deep Protobuf messages may be nested
  std::chrono::milliseconds hello_deadline{2000};  // for the whole Hello, counted from connecting
  std::chrono::milliseconds frame_deadline{1000};  // from a frame's first byte to its last
  std::chrono::milliseconds http_head_deadline{
      5000};                                        // from the first byte of a request to the end of its head
  std::chrono::milliseconds stall_deadline{2000};   // a session that takes no bytes for so long is closed
  std::size_t max_sessions = 512;                   // that have said Hello
  std::size_t places_for_admins = 16;               // of them, and beyond the limits of an address
  std::size_t max_sessions_per_peer = 128;          // from one address; IPv6: from one network of 64 bits
  std::size_t max_sessions_per_local_peer = 384;    // from one address of loopback
  std::size_t max_unauthenticated = 32;             // a further one takes the place of an older one
  double accepts_per_second = 200.0;                // those above it wait; each address has its turn
  std::size_t max_http_connections = 64;            // a further one takes the place of an older one
  std::chrono::milliseconds longest_hold_back{10};  // of replies that wait for those that follow
  std::size_t max_queued_replies = 1024;            // per session; above it the session is closed
  std::size_t max_queued_bytes = 256u << 10;  // replies and events that wait, besides the batch being written
};

}  // namespace visum::protocol
