// The datagrams of an emergency stop, which needs no session. SPEC.md, section 11, describes them. Pure
// functions over bytes, any thread; the server's end is server/gateway/stop_door.h, the client's stop_call.h.
//
// A client asks for a cookie and is challenged with one. It then orders the stop with that cookie, and with
// the proof that it knows a token where the server has tokens. The server answers an order twice: that it is
// latched, and that it has acted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "protocol/keyed_hash.h"

namespace visum::protocol {

using StopNonce = std::array<std::byte, 16>;  // chosen by the client; all answers repeat it

// How a client shows that it may stop parts.
enum class StopProof : std::uint8_t {
  kNone = 0,    // the cookie is enough: everybody on this machine may
  kToken = 1,   // it knows one of the tokens, whatever its role
  kSession = 2  // the server knows certificates only, and takes the order in a session
};
enum class StopRefusal : std::uint8_t {
  kCookie = 1,   // of another address, or too old: ask again
  kProof = 2,    // no token of this server
  kPart = 3,     // there is no such part
  kSession = 4,  // see StopProof::kSession
  kBusy = 5      // too many orders wait for the tick
};

struct StopAsk {
  StopNonce nonce{};
};
struct StopChallenge {
  StopNonce nonce{};
  KeyedHash cookie{};
  StopProof proof = StopProof::kNone;
};
struct StopOrder {
  StopNonce nonce{};
  KeyedHash cookie{};
  KeyedHash proof{};  // stop_proof(); zeros where none is needed
  std::string part;   // at most kMaxStopPart bytes; empty: all parts
};
struct StopLatched {
  StopNonce nonce{};
};
struct StopActed {
  StopNonce nonce{};
  std::int64_t tick = 0;  // the border at which the parts stopped
};
struct StopRefused {
  StopNonce nonce{};
  StopRefusal why = StopRefusal::kCookie;
};
using StopDatagram = std::variant<StopAsk, StopChallenge, StopOrder, StopLatched, StopActed, StopRefused>;

inline constexpr std::size_t kMaxStopPart = 255;
// No answer is longer than the datagram that it answers. So the server cannot be used to flood others.
inline constexpr std::size_t kStopAskBytes = 96;
inline constexpr std::size_t kStopOrderBytes = 384;

// `part` beyond kMaxStopPart is cut.
std::vector<std::byte> encode(const StopDatagram& datagram);
// Nothing: these bytes are no datagram of ours.
std::optional<StopDatagram> decode_stop(std::span<const std::byte> bytes);

// The proof that the sender of an order knows a token.
KeyedHash stop_proof(const std::string& token, const KeyedHash& cookie, const std::string& part);

}  // namespace visum::protocol
