#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "protocol/codec.h"
#include "protocol/limits.h"
#include "tests/protocol/sample_messages.h"
#include "tests/protocol/schema.h"
#include "tests/protocol/vectors.h"

namespace visum::protocol {
namespace {

using ::testing::HasSubstr;
using testing::make_vectors;
using testing::Schema;
using Bytes = std::vector<std::byte>;

constexpr int kDepth = Limits{}.max_depth;

std::span<const std::byte> payload_of(const Bytes& frame) {
  return std::span(frame).subspan(kHeaderBytes);
}

// Decodes as the receiving side would, and encodes again. Nothing if it was refused, which must come with a
// reason.
std::optional<Bytes> again(const std::string& message, std::span<const std::byte> payload) {
  std::string why;
  Bytes frame;
  if (message == "ClientMessage") {
    if (const auto request = decode_request(payload, kDepth, why)) {
      encode_request(request->id, request->request, frame);
      return frame;
    }
  } else if (const auto reply = decode_reply(payload, why)) {
    encode_reply(reply->reply_to, reply->reply, frame);
    return frame;
  }
  EXPECT_FALSE(why.empty());
  return std::nullopt;
}

TEST(Codec, SamplesCoverEveryKindOfMessage) {
  std::set<std::size_t> requests, replies;
  for (const auto& [name, request] : testing::sample_requests()) requests.insert(request.index());
  for (const auto& [name, reply] : testing::sample_replies()) replies.insert(reply.index());
  EXPECT_EQ(requests.size(), std::variant_size_v<Request>);
  EXPECT_EQ(replies.size(), std::variant_size_v<Reply>);
}

TEST(Codec, SamplesCoverEveryFieldOfTheSchema) {
  const Schema schema;
  for (const auto& vector : make_vectors()) {
    const auto missing = schema.unset_fields(vector.message, payload_of(vector.frame));
    EXPECT_TRUE(missing.empty()) << vector.name << ": " << ::testing::PrintToString(missing);
  }
}

TEST(Codec, EveryMessageSurvivesTheRoundTrip) {
  for (const auto& vector : make_vectors())
    EXPECT_EQ(again(vector.message, payload_of(vector.frame)), vector.frame) << vector.name;
}

TEST(Codec, RoundTripKeepsKindAndId) {
  std::string why;
  for (const auto& [name, request] : testing::sample_requests()) {
    Bytes frame;
    encode_request(77, request, frame);
    const auto decoded = decode_request(payload_of(frame), kDepth, why);
    ASSERT_TRUE(decoded) << name << ": " << why;
    EXPECT_EQ(decoded->id, 77u);
    EXPECT_EQ(decoded->request.index(), request.index()) << name;
  }
}

TEST(Codec, WriteCarriesItsFields) {
  Bytes frame;
  encode_request(1, Write{"arm", 3, {1.5, -2.5}, 9}, frame);
  std::string why;
  const auto decoded = decode_request(payload_of(frame), kDepth, why);
  ASSERT_TRUE(decoded) << why;
  const auto& write = std::get<Write>(decoded->request);
  EXPECT_EQ(write.part, "arm");
  EXPECT_EQ(write.first_port, 3u);
  EXPECT_EQ(write.values, (std::vector<double>{1.5, -2.5}));
  EXPECT_EQ(write.sequence, 9u);
}

TEST(Codec, AbsentFieldsAreZeroNotTheStructsDefault) {
  Bytes frame;
  encode_request(1, Subscribe{"arm", 0}, frame);
  std::string why;
  EXPECT_EQ(std::get<Subscribe>(decode_request(payload_of(frame), kDepth, why)->request).every_n_ticks, 0u);
}

TEST(Codec, AppendsSoThatFramesCanBeBatched) {
  Bytes two;
  encode_reply(1, Ok{}, two);
  const std::size_t first = two.size();
  encode_reply(2, Advanced{5, 5, 1}, two);
  EXPECT_EQ(frame_length(std::span<const std::byte, 4>(two.data(), 4)) + kHeaderBytes, first);
  EXPECT_EQ(frame_length(std::span<const std::byte, 4>(two.data() + first, 4)) + kHeaderBytes,
            two.size() - first);
}

TEST(Codec, HeaderIsLittleEndian) {
  const std::array<std::byte, 4> header{std::byte{0x04}, std::byte{0x03}, std::byte{0x02}, std::byte{0x01}};
  EXPECT_EQ(frame_length(header), 0x01020304u);
}

// ---------------------------------------- refusals

TEST(Codec, RefusesAMessageWithoutARequest) {
  std::string why;
  EXPECT_FALSE(decode_request({}, kDepth, why));
  EXPECT_THAT(why, HasSubstr("no request"));
  EXPECT_FALSE(decode_reply({}, why));
  EXPECT_THAT(why, HasSubstr("no reply"));
}

TEST(Codec, RefusesAnUnknownRequest) {
  const Bytes unknown = testing::to_bytes(std::string("\x08\x01\xFA\x06\x00", 5));  // id = 1, field 111 = {}
  std::string why;
  EXPECT_FALSE(decode_request(unknown, kDepth, why));
  EXPECT_THAT(why, HasSubstr("no request that this version knows"));
}

TEST(Codec, IgnoresUnknownFieldsOfAKnownRequest) {
  Bytes frame;
  encode_request(1, Status{}, frame);
  const Bytes extra = testing::to_bytes(std::string("\xF8\x3F\x05", 3));  // field 1023 = 5
  frame.insert(frame.end(), extra.begin(), extra.end());
  std::string why;
  EXPECT_TRUE(decode_request(payload_of(frame), kDepth, why)) << why;
}

TEST(Codec, RefusesARoleThatDoesNotExist) {
  const Bytes payload = Schema().to_payload("ClientMessage", R"({"hello": {"max_version": 1, "role": 9}})");
  std::string why;
  EXPECT_FALSE(decode_request(payload, kDepth, why));
  EXPECT_EQ(why, "role 9 does not exist");
}

TEST(Codec, RefusesAParameterWithoutAValue) {
  const Schema schema;
  std::string why;
  EXPECT_FALSE(decode_request(schema.to_payload("ClientMessage", R"({"set_parameter": {"part": "arm"}})"),
                              kDepth, why));
  EXPECT_EQ(why, "a parameter without a value");
}

TEST(Codec, RefusesNamesThatAreNotUtf8) {
  Bytes frame;
  encode_request(1, Read{"arm"}, frame);
  frame[frame.size() - 2] = std::byte{0xFF};
  std::string why;
  EXPECT_FALSE(decode_request(payload_of(frame), kDepth, why));
  EXPECT_THAT(why, HasSubstr("UTF-8"));
}

TEST(Codec, RefusesNestingBeyondTheLimit) {
  const auto nested = [](int depth) {  // groups of the unknown field 1000, one inside the other
    std::string text;
    for (int i = 0; i < depth; ++i) text += "\xC3\x3E";
    for (int i = 0; i < depth; ++i) text += "\xC4\x3E";
    return testing::to_bytes(text + std::string("\x1A\x00", 2));  // status = {}
  };
  std::string why;
  EXPECT_TRUE(decode_request(nested(kDepth - 1), kDepth, why)) << why;
  EXPECT_FALSE(decode_request(nested(kDepth + 1), kDepth, why));
}

TEST(Codec, RefusesALengthBeyondThePayloadWithoutAllocatingIt) {
  // write = { values = 0x7FFFFFF0 bytes that are not there }
  const Bytes payload = testing::to_bytes(std::string("\x72\x06\x1A\xF0\xFF\xFF\xFF\x07", 8));
  std::string why;
  EXPECT_FALSE(decode_request(payload, kDepth, why));
}

}  // namespace
}  // namespace visum::protocol
