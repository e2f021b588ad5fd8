// The first bytes of a connection: each side says who it is and what it wants.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace visum::finroc {

inline constexpr std::uint8_t kEndMark = 0xCD;  // ends the greeting and each message

// The elements that a peer wants to be told of.
enum class Structure : std::uint8_t { kNone = 0, kSharedPorts = 1, kWhole = 2, kFinstruct = 3 };

namespace connection {
inline constexpr std::uint32_t kPrimary = 1, kExpress = 2, kBulk = 4, kJava = 8, kNoEndMarks = 16;
}

struct Greeting {
  std::string host;            // of the UUID
  std::int32_t process = 0;    // of the UUID: a server's port, or minus a client's process id
  std::uint8_t peer_type = 1;  // 0 client, 1 server, 2 both
  std::string name;            // shown to users
  Structure wants = Structure::kNone;
  std::uint32_t flags = 0;
};

struct GreetingRead {
  enum class State { kNeedsMore, kBad, kComplete };
  State state = State::kNeedsMore;
  std::size_t taken = 0;  // bytes, if it is complete
  Greeting greeting;
  std::string why;  // if it is bad
};

// Reads a peer's greeting from the beginning of what it has sent.
GreetingRead read_greeting(std::span<const std::byte> bytes);
std::string write_greeting(const Greeting& greeting);

}  // namespace visum::finroc
