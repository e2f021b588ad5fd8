// Bytes that no correct client sends: cut off, random, and with every number at its extremes.
#include <gtest/gtest.h>

#include <random>

#include "protocol/codec.h"
#include "protocol/limits.h"
#include "tests/protocol/memory_probe.h"
#include "tests/protocol/schema.h"
#include "tests/protocol/vectors.h"

namespace visum::protocol {
namespace {

using testing::make_vectors;
using testing::Vector;
using Bytes = std::vector<std::byte>;

constexpr int kMostDepth = Limits{}.max_depth;

std::span<const std::byte> payload_of(const Vector& vector) {
  return std::span(vector.frame).subspan(kHeaderBytes);
}

// Decodes, and encodes again what was decoded. Returns true if it was a message. A refusal must have a
// reason.
bool survives(const std::string& message, std::span<const std::byte> payload, Bytes& frame) {
  std::string why;
  frame.clear();
  if (message == "ClientMessage") {
    if (const auto request = decode_request(payload, kMostDepth, why))
      return encode_request(request->id, request->request, frame), true;
  } else if (const auto reply = decode_reply(payload, why)) {
    return encode_reply(reply->reply_to, reply->reply, frame), true;
  }
  EXPECT_FALSE(why.empty());
  return false;
}

TEST(Hostile, MessagesCutAtEveryByteAreRefusedOrSmaller) {
  Bytes frame;
  for (const Vector& vector : make_vectors()) {
    const auto payload = payload_of(vector);
    for (std::size_t length = 0; length < payload.size(); ++length)
      if (survives(vector.message, payload.first(length), frame)) {
        EXPECT_LE(frame.size() - kHeaderBytes, length) << vector.name;
      }
  }
}

TEST(Hostile, EveryNumberAtItsExtremesIsCarriedOrRefused) {
  const testing::Schema schema;
  Bytes frame;
  int tried = 0;
  for (const Vector& vector : make_vectors())
    schema.for_each_extreme(vector.message, payload_of(vector), [&](const std::string& where, auto payload) {
      ++tried;
      const auto is = [&](const char* field) { return where.find(field) != std::string::npos; };
      const bool is_enumerator = is("role[") || is("code[") || is("on_timeout[") || is("scope[") ||
                                 is("level[") || is("vector[") || is("verdict[");
      EXPECT_EQ(survives(vector.message, payload, frame), !is_enumerator) << vector.name << ": " << where;
      if (is_enumerator) return;
      // The message arrives bit by bit as it was sent: nothing is clamped or normalised on the way.
      EXPECT_TRUE(std::ranges::equal(std::span(frame).subspan(kHeaderBytes), payload))
          << vector.name << ": " << where;
    });
  EXPECT_GT(tried, 400);
}

TEST(Hostile, RandomBytesAreRefusedOrCarried) {
  std::mt19937_64 random(20080722);
  Bytes payload, frame;
  for (int i = 0; i < 50'000; ++i) {
    payload.resize(random() % 200);
    for (std::byte& byte : payload) byte = static_cast<std::byte>(random());
    survives("ClientMessage", payload, frame);
    survives("ServerMessage", payload, frame);
  }
}

TEST(Hostile, MessagesWithFlippedBytesAreRefusedOrCarried) {
  std::mt19937_64 random(7);
  const auto vectors = make_vectors();
  Bytes frame;
  for (int i = 0; i < 100'000; ++i) {
    const Vector& vector = vectors[random() % vectors.size()];
    Bytes payload(payload_of(vector).begin(), payload_of(vector).end());
    for (int flips = 1 + static_cast<int>(random() % 4); flips > 0; --flips)
      payload[random() % payload.size()] = static_cast<std::byte>(random());
    survives(vector.message, payload, frame);
  }
}

// The memory that a frame can cost beyond its own size: many empty sub-messages or fields, each of which
// becomes an object.
TEST(Hostile, AFrameOf64KiBCostsLessThan8MiB) {
  const std::string bombs[] = {
      std::string("\x72\x00", 2),              // write = {}
      std::string("\x72\x00\x7A\x00", 4),      // write = {} and read = {} in turn
      std::string("\xC2\x3E\x00", 3),          // unknown field 1000 = ""
      std::string("\xC3\x3E\xC4\x3E", 4),      // unknown group 1000
      std::string("\x9A\x01\x02\x1A\x00", 5),  // set_parameter = { value = {} }
      std::string("\x72\x02\x1A\x00", 4),      // write = { values = [] }
  };
  for (const std::string& bomb : bombs) {
    std::string text;
    while (text.size() + bomb.size() <= Limits{}.max_frame) text += bomb;
    const Bytes payload = testing::to_bytes(text);
    Bytes frame;
    const std::size_t most =
        testing::most_allocated_during([&] { survives("ClientMessage", payload, frame); });
    EXPECT_LT(most, 8u << 20) << ::testing::PrintToString(bomb);
  }
}

TEST(Hostile, AFrameOf16MiBCostsLessThan64MiB) {
  for (const std::string& bomb : {std::string("\x72\x00\x7A\x00", 4), std::string("\xC2\x3E\x00", 3)}) {
    std::string text;
    while (text.size() + bomb.size() <= Limits{}.max_frame_admin) text += bomb;
    const Bytes payload = testing::to_bytes(text);
    Bytes frame;
    const std::size_t most =
        testing::most_allocated_during([&] { survives("ClientMessage", payload, frame); });
    EXPECT_LT(most, 64u << 20) << ::testing::PrintToString(bomb);
  }
}

}  // namespace
}  // namespace visum::protocol
