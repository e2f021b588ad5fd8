// Only this file and wire_*.cc know Protobuf. They use the lite runtime, because it keeps unknown fields as
// the bytes that arrived; the full runtime turns each unknown field into an object.
#include "protocol/codec.h"

#include <google/protobuf/arena.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/stubs/logging.h>

#include <array>
#include <limits>

#include "protocol/limits.h"
#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol {
namespace {

using google::protobuf::Arena;

// Errors about bad messages are returned as values. Protobuf would also write them to standard error, and a
// hostile client could fill the log.
[[maybe_unused]] const bool kProtobufIsQuiet = (google::protobuf::SetLogHandler(nullptr), true);

// Messages above this size are parsed on the heap. An arena keeps what a repeated oneof throws away, so a
// message made of empty sub-messages would need many times its own size.
constexpr std::size_t kMaxOnArena = 64u << 10;

// One arena per thread, emptied after each message, so that frequent messages need no allocation.
class Scratch {
 public:
  Scratch() : arena_(options(block_)) {}
  template <typename Message>
  Message& make() {
    return *Arena::CreateMessage<Message>(&arena_);
  }
  void reset() { arena_.Reset(); }

 private:
  static google::protobuf::ArenaOptions options(std::array<char, 8192>& block) {
    google::protobuf::ArenaOptions options;
    options.initial_block = block.data();
    options.initial_block_size = block.size();
    return options;
  }
  alignas(8) std::array<char, 8192> block_;
  Arena arena_;
};

Scratch& scratch() {
  thread_local Scratch scratch;
  return scratch;
}

struct ResetOnExit {
  ~ResetOnExit() { scratch().reset(); }
};

template <typename Message>
bool parse(std::span<const std::byte> payload, int max_depth, Message& message) {
  if (payload.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return false;
  // The payload is one flat array, so every length in it is checked against what is left before memory is
  // allocated.
  google::protobuf::io::CodedInputStream input(reinterpret_cast<const std::uint8_t*>(payload.data()),
                                               static_cast<int>(payload.size()));
  input.SetRecursionLimit(max_depth);
  return message.ParseFromCodedStream(&input) && input.ConsumedEntireMessage();
}

template <typename Message, typename Body>
bool decode(std::span<const std::byte> payload, int max_depth, Message& message, std::uint64_t& id,
            Body& body, std::string& why) {
  if (!parse(payload, max_depth, message)) {
    why = "not a message of this protocol (cut short, nested too deeply, or text that is not UTF-8)";
    return false;
  }
  if constexpr (std::is_same_v<Message, v1::ClientMessage>)
    id = message.id();
  else
    id = message.reply_to();
  return wire::take(message, body, why);
}

template <typename Message, typename Body>
bool decode_anywhere(std::span<const std::byte> payload, int max_depth, std::uint64_t& id, Body& body,
                     std::string& why) {
  if (payload.size() > kMaxOnArena) {
    Message message;
    return decode(payload, max_depth, message, id, body, why);
  }
  const ResetOnExit reset;
  return decode(payload, max_depth, scratch().make<Message>(), id, body, why);
}

template <typename Message>
void append(const Message& message, std::vector<std::byte>& out) {
  const std::size_t length = message.ByteSizeLong();
  const std::size_t start = out.size();
  out.resize(start + kHeaderBytes + length);
  std::byte* at = out.data() + start;
  for (std::size_t i = 0; i < kHeaderBytes; ++i) at[i] = static_cast<std::byte>(length >> (8 * i));
  message.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(at + kHeaderBytes));
}

}  // namespace

std::uint32_t frame_length(std::span<const std::byte, kHeaderBytes> header) {
  std::uint32_t length = 0;
  for (std::size_t i = 0; i < kHeaderBytes; ++i) length |= static_cast<std::uint32_t>(header[i]) << (8 * i);
  return length;
}

std::optional<RequestFrame> decode_request(std::span<const std::byte> payload, int max_depth,
                                           std::string& why) {
  std::optional<RequestFrame> frame(std::in_place);
  if (!decode_anywhere<v1::ClientMessage>(payload, max_depth, frame->id, frame->request, why)) frame.reset();
  return frame;
}

std::optional<ReplyFrame> decode_reply(std::span<const std::byte> payload, std::string& why) {
  std::optional<ReplyFrame> frame(std::in_place);
  if (!decode_anywhere<v1::ServerMessage>(payload, Limits{}.max_depth, frame->reply_to, frame->reply, why))
    frame.reset();
  return frame;
}

void encode_request(std::uint64_t id, const Request& request, std::vector<std::byte>& out) {
  const ResetOnExit reset;
  auto& message = scratch().make<v1::ClientMessage>();
  message.set_id(id);
  wire::put(request, message);
  append(message, out);
}

void encode_reply(std::uint64_t reply_to, const Reply& reply, std::vector<std::byte>& out) {
  const ResetOnExit reset;
  auto& message = scratch().make<v1::ServerMessage>();
  message.set_reply_to(reply_to);
  wire::put(reply, message);
  append(message, out);
}

}  // namespace visum::protocol
