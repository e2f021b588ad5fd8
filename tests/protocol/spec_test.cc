// SPEC.md's worked example, read from SPEC.md itself. Each frame there is a block:
//   ```frame client Write          the sender and the kind of message
//   0b 00 00 00 ...                the bytes, header included; text after # explains
//   ```
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "protocol/codec.h"
#include "protocol/limits.h"
#include "tests/protocol/schema.h"
#include "tests/protocol/vectors.h"

namespace visum::testing {
namespace {

struct Example {
  std::string sender, json;
  std::vector<std::byte> frame;
};

std::vector<Example> examples() {
  std::istringstream spec(read_file(VISUM_SOURCE_DIR "/protocol/SPEC.md"));
  const std::regex begin(R"(```frame (client|server) (\{.*\}))"), byte(R"([0-9a-f]{2}\b)");
  std::vector<Example> found;
  bool inside = false;
  for (std::string line; std::getline(spec, line);) {
    std::smatch match;
    if (std::regex_match(line, match, begin)) {
      found.push_back({match[1], match[2], {}});
      inside = true;
    } else if (line == "```") {
      inside = false;
    } else if (inside) {
      const std::string hex = line.substr(0, line.find('#'));
      for (std::sregex_iterator at(hex.begin(), hex.end(), byte); at != std::sregex_iterator(); ++at)
        found.back().frame.push_back(static_cast<std::byte>(std::stoi(at->str(), nullptr, 16)));
    }
  }
  return found;
}

TEST(Spec, ShowsAWholeSession) {
  EXPECT_GE(examples().size(), 6u);
}

TEST(Spec, FramesOfTheExampleSayWhatTheTextSays) {
  const Schema schema;
  for (const Example& example : examples()) {
    const std::string message = example.sender == "client" ? "ClientMessage" : "ServerMessage";
    const std::span<const std::byte> frame(example.frame);
    ASSERT_GE(frame.size(), protocol::kHeaderBytes) << example.json;
    EXPECT_EQ(protocol::frame_length(frame.first<4>()), frame.size() - 4) << example.json;
    EXPECT_EQ(schema.to_payload(message, example.json),
              to_bytes(std::string(reinterpret_cast<const char*>(frame.data()) + 4, frame.size() - 4)))
        << example.json;
  }
}

TEST(Spec, FramesOfTheExampleAreWhatTheCodecWrites) {
  for (const Example& example : examples()) {
    const auto payload = std::span<const std::byte>(example.frame).subspan(protocol::kHeaderBytes);
    std::string why;
    std::vector<std::byte> again;
    if (example.sender == "client") {
      const auto request = protocol::decode_request(payload, protocol::Limits{}.max_depth, why);
      ASSERT_TRUE(request) << example.json << ": " << why;
      protocol::encode_request(request->id, request->request, again);
    } else {
      const auto reply = protocol::decode_reply(payload, why);
      ASSERT_TRUE(reply) << example.json << ": " << why;
      protocol::encode_reply(reply->reply_to, reply->reply, again);
    }
    EXPECT_EQ(again, example.frame) << example.json;
  }
}

}  // namespace
}  // namespace visum::testing
