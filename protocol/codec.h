// Encodes and decodes frames: a 4-byte little-endian length, then that many bytes of one ClientMessage or
// ServerMessage (SPEC.md, section 1). Pure functions, for any thread. A bad frame is returned as a value;
// nothing throws.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::protocol {

struct RequestFrame {
  std::uint64_t id = 0;
  Request request;
};
struct ReplyFrame {
  std::uint64_t reply_to = 0;
  Reply reply;
};

// Reads the length of the payload from a frame's header.
inline constexpr std::size_t kHeaderBytes = 4;
std::uint32_t frame_length(std::span<const std::byte, kHeaderBytes> header);

// Decodes a frame's payload (without its header). Returns nothing if it is not a valid message; `why` then
// says what is wrong in a few words. `max_depth` bounds how deep messages may be nested.
std::optional<RequestFrame> decode_request(std::span<const std::byte> payload, int max_depth,
                                           std::string& why);
std::optional<ReplyFrame> decode_reply(std::span<const std::byte> payload, std::string& why);

// Appends header and payload to `out`. Texts must be UTF-8: a receiver refuses a frame with any other text.
void encode_request(std::uint64_t id, const Request& request, std::vector<std::byte>& out);
void encode_reply(std::uint64_t reply_to, const Reply& reply, std::vector<std::byte>& out);

}  // namespace visum::protocol
