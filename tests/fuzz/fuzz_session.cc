// Any bytes as a payload for the codec and as a stream into a session, before and after its hello. The result
// must be an answer or a close. The sanitizers find anything else.
#include <spdlog/spdlog.h>

#include "protocol/codec.h"
#include "protocol/limits.h"
#include "tests/fuzz/answering.h"
#include "tests/protocol/memory_session.h"

namespace {

using namespace visum::protocol;
using visum::testing::Answering;
using visum::testing::fail;
using visum::testing::MemorySession;
using Bytes = std::span<const std::byte>;

void into_a_session(Bytes bytes, bool greeted) {
  const Limits limits;
  Answering handler;
  SessionContext context{limits, handler};
  MemorySession session(context);
  if (greeted) {
    std::vector<std::byte> hello;
    encode_request(1, Hello{1, kProtocolVersion, "fuzz", Role::kAdmin, ""}, hello);
    session.feed(hello);
  }
  const std::size_t piece = bytes.empty() ? 1 : 1 + static_cast<std::size_t>(bytes.back());
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    session.feed(bytes.subspan(at, std::min(piece, bytes.size() - at)));
    session.sweep();
  }
  session.end();
  if (!session.closing()) fail("the session did not end");
  if (handler.open != 0) fail("a close was told twice or never");
}

// A message that was decoded once must be the same after encoding and decoding again.
void into_the_codec(Bytes bytes) {
  std::string why;
  std::vector<std::byte> first, second;
  if (const auto request = decode_request(bytes, Limits{}.max_depth, why)) {
    encode_request(request->id, request->request, first);
    const auto again = decode_request(Bytes(first).subspan(kHeaderBytes), Limits{}.max_depth, why);
    if (!again) fail("a request that was encoded here is refused");
    encode_request(again->id, again->request, second);
    if (first != second) fail("a request changed on the way");
  }
  first.clear();
  second.clear();
  if (const auto reply = decode_reply(bytes, why)) {
    encode_reply(reply->reply_to, reply->reply, first);
    const auto again = decode_reply(Bytes(first).subspan(kHeaderBytes), why);
    if (!again) fail("a reply that was encoded here is refused");
    encode_reply(again->reply_to, again->reply, second);
    if (first != second) fail("a reply changed on the way");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (spdlog::set_level(spdlog::level::off), true);
  static_cast<void>(quiet);
  const Bytes bytes = std::as_bytes(std::span(data, size));
  into_the_codec(bytes);
  if (size > kHeaderBytes) into_the_codec(bytes.subspan(kHeaderBytes));
  into_a_session(bytes, true);
  into_a_session(bytes, false);
  return 0;
}
