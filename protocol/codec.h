// Frames: a 4-byte little-endian length, then that many bytes of one ClientMessage or ServerMessage. Pure
// functions, any thread. A bad frame is a value, never an exception.
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

inline constexpr std::size_t kHeaderBytes = 4;
std::uint32_t frame_length(std::span<const std::byte, kHeaderBytes> header);

// The payload of a frame, without its header. Nothing if it is no message of ours; `why` then says so in a
// few words.
std::optional<RequestFrame> decode_request(std::span<const std::byte> payload, int max_depth,
                                           std::string& why);
std::optional<ReplyFrame> decode_reply(std::span<const std::byte> payload, std::string& why);

// Appends header and payload to `out`. Texts must be UTF-8: the receiver refuses a frame with any that is
// not.
void encode_request(std::uint64_t id, const Request& request, std::vector<std::byte>& out);
void encode_reply(std::uint64_t reply_to, const Reply& reply, std::vector<std::byte>& out);

}  // namespace visum::protocol
