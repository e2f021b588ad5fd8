// The two codecs against worked frames (bytes and JSON under vectors/), against frames cut at every byte, and
// against the frames of clients that bend the rules.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "hwparts/powercube/can_codec.h"
#include "hwparts/powercube/serial_codec.h"
#include "protocol/config/config.h"

namespace visum::powercube {
namespace {

using Bytes = std::vector<std::uint8_t>;
namespace fs = std::filesystem;

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  std::string digits;
  std::ranges::copy_if(text, std::back_inserter(digits), [](char c) { return c != ' '; });
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(digits.substr(i, 2), nullptr, 16)));
  return bytes;
}

struct Vector {
  Bytes bytes;
  config::Node says;
};

Vector load(const std::string& name) {
  const fs::path folder = VISUM_SOURCE_DIR "/tests/hwparts/powercube/vectors";
  std::ifstream file(folder / (name + ".bin"), std::ios::binary);
  return {{std::istreambuf_iterator<char>(file), {}}, config::load_file(folder / (name + ".json"))};
}

Telegram telegram_of(const config::Node& says) {
  const std::string words[] = {"get", "set", "broadcast", "answer", "state"};
  const auto kind = std::ranges::find(words, says.get("kind").text()) - std::begin(words);
  Telegram telegram{
      static_cast<Telegram::Kind>(kind), static_cast<std::uint8_t>(says.get("module").integer(0, 31)), {}};
  for (const auto byte : from_hex(says.get("data").text())) telegram.message.put(byte);
  return telegram;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry :
       fs::directory_iterator(VISUM_SOURCE_DIR "/tests/hwparts/powercube/vectors/" + folder))
    if (entry.path().extension() == ".bin") names.push_back(folder + "/" + entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  return info.param.substr(info.param.find('/') + 1);
}

class SerialVector : public testing::TestWithParam<std::string> {};

TEST_P(SerialVector, DecodesAndEncodesToTheSameBytes) {
  const auto vector = load(GetParam());
  ASSERT_EQ(vector.bytes, from_hex(vector.says.get("bytes").text()));
  const auto decoded = decode_serial(vector.bytes);
  ASSERT_EQ(decoded.progress, Progress::kComplete);
  EXPECT_EQ(decoded.taken, vector.bytes.size());
  EXPECT_EQ(decoded.telegram, telegram_of(vector.says));
  EXPECT_EQ(decoded.checksum_ok, vector.says.get("m5api_checksum").boolean());
  const auto again = encode_serial(decoded.telegram);
  EXPECT_EQ(std::ranges::equal(again.bytes(), vector.bytes), decoded.checksum_ok);
  EXPECT_EQ(decode_serial(again.bytes()).telegram, decoded.telegram);
}

TEST_P(SerialVector, NeedsMoreAtEveryCut) {
  const auto bytes = load(GetParam()).bytes;
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    const auto decoded = decode_serial(std::span(bytes).first(cut));
    EXPECT_EQ(decoded.progress, Progress::kNeedsMore) << "cut at " << cut;
    EXPECT_EQ(decoded.taken, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Wire, SerialVector, testing::ValuesIn(names_in("serial")), test_name);

class CanVector : public testing::TestWithParam<std::string> {};

TEST_P(CanVector, DecodesAndEncodesToTheSameBytes) {
  const auto vector = load(GetParam());
  const auto decoded = decode_slcan(vector.bytes);
  ASSERT_EQ(decoded.progress, Progress::kComplete);
  EXPECT_EQ(decoded.taken, vector.bytes.size());
  EXPECT_EQ(decoded.frame.id,
            static_cast<std::uint32_t>(std::stoul(vector.says.get("id").text(), nullptr, 16)));
  const auto telegram = from_can(decoded.frame);
  ASSERT_TRUE(telegram);
  EXPECT_EQ(*telegram, telegram_of(vector.says));
  EXPECT_EQ(to_can(*telegram), decoded.frame);
  EXPECT_TRUE(std::ranges::equal(encode_slcan(decoded.frame).bytes(), vector.bytes));
}

TEST_P(CanVector, NeedsMoreAtEveryCut) {
  const auto bytes = load(GetParam()).bytes;
  for (std::size_t cut = 0; cut < bytes.size(); ++cut)
    EXPECT_EQ(decode_slcan(std::span(bytes).first(cut)).progress, Progress::kNeedsMore) << "cut at " << cut;
}

INSTANTIATE_TEST_SUITE_P(Wire, CanVector, testing::ValuesIn(names_in("can")), test_name);

// Telegrams to every module, of every length and every byte value, also those that are special on the line.
TEST(SerialCodec, EveryModuleLengthAndSpecialByteComesBack) {
  for (int module = 0; module <= kMaxModule; ++module) {
    for (std::size_t size = 1; size <= kMaxData; ++size) {
      for (int byte = 0; byte < 256; ++byte) {
        Telegram telegram{Telegram::Kind::kSet, static_cast<std::uint8_t>(module), {}};
        for (std::size_t i = 0; i < size; ++i) telegram.message.put(static_cast<std::uint8_t>(byte));
        if (byte == command::kGetParameter) telegram.kind = Telegram::Kind::kGet;
        if (module == 0) telegram.kind = Telegram::Kind::kBroadcast;
        const auto encoded = encode_serial(telegram);
        ASSERT_LE(encoded.size, kMaxSerialBytes);
        ASSERT_TRUE(std::ranges::count(encoded.bytes(), 0x03) == 1 &&
                    std::ranges::count(encoded.bytes(), 0x02) == 1);
        const auto decoded = decode_serial(encoded.bytes());
        ASSERT_EQ(decoded.progress, Progress::kComplete);
        ASSERT_EQ(decoded.telegram, telegram);
        ASSERT_TRUE(decoded.checksum_ok);
      }
    }
  }
}

// Decodes as a link does it: drops bad bytes and returns the telegrams.
std::vector<Telegram> drain(Bytes bytes) {
  std::vector<Telegram> got;
  for (auto decoded = decode_serial(bytes); decoded.progress != Progress::kNeedsMore;
       decoded = decode_serial(bytes)) {
    EXPECT_GT(decoded.taken, 0u);
    if (decoded.progress == Progress::kComplete) got.push_back(decoded.telegram);
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(decoded.taken));
  }
  return got;
}

const Telegram kGetVersion{Telegram::Kind::kGet, 1, {0x0A, 0x1D}};

TEST(SerialCodec, AcceptsAnyChecksum) {
  for (int bcc = 0; bcc < 256; ++bcc) {
    if (bcc == 0x02 || bcc == 0x03 || bcc == 0x10) continue;  // would have been escaped
    const auto decoded =
        decode_serial(Bytes{0x02, 0x04, 0x22, 0x0A, 0x1D, static_cast<std::uint8_t>(bcc), 0x03});
    ASSERT_EQ(decoded.progress, Progress::kComplete);
    EXPECT_EQ(decoded.telegram, kGetVersion);
    EXPECT_EQ(decoded.checksum_ok, bcc == 0x4D);
  }
}

TEST(SerialCodec, AcceptsUnescapedHeaders) {
  const auto two = drain(from_hex("02 05 02 0a 1d 2c 03"));
  ASSERT_EQ(two.size(), 1u);
  EXPECT_EQ(two[0], (Telegram{Telegram::Kind::kGet, 8, {0x0A, 0x1D}}));
  const auto three = drain(from_hex("02 06 03 08 54 40 9c 03"));
  ASSERT_EQ(three.size(), 1u);
  EXPECT_EQ(three[0], (Telegram{Telegram::Kind::kSet, 16, {0x08, 0x54, 0x40}}));
}

// RobWork: BCC always 11, escapes counted in n.
TEST(SerialCodec, AcceptsCountsThatIncludeEscapes) {
  const auto got = drain(from_hex("02 05 88 0b 04 10 82 00 10 83 3f 11 03"));
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(got[0], (Telegram{Telegram::Kind::kSet, 12, {0x0B, 0x04, 0x02, 0x00, 0x03, 0x3F}}));
}

TEST(SerialCodec, ResumesAtTheNextFrameAfterABrokenOne) {
  const auto whole = from_hex("02 04 22 0a 1d 4d 03");
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    Bytes bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
    bytes.insert(bytes.end(), whole.begin(), whole.end());
    const auto got = drain(bytes);
    ASSERT_FALSE(got.empty()) << "cut at " << cut;
    EXPECT_EQ(got.back(), kGetVersion) << "cut at " << cut;
  }
}

TEST(SerialCodec, NeverHangsOnNoise) {
  std::uint32_t random = 1;
  Bytes line;
  for (int i = 0; i < 200'000; ++i) {
    random = random * 1664525u + 1013904223u;
    // The special bytes come often: noise of plain bytes is dropped at once.
    constexpr std::uint8_t kOften[] = {0x02, 0x03, 0x10, 0x04, 0x22, 0x82, 0x0A};
    line.push_back(random >> 31 ? kOften[(random >> 16) % 7] : static_cast<std::uint8_t>(random >> 16));
    const auto decoded = decode_serial(line);
    if (decoded.progress == Progress::kNeedsMore) {
      ASSERT_LT(line.size(), kMaxSerialBytes);
      ASSERT_EQ(decoded.taken, 0u);
    } else {
      ASSERT_GT(decoded.taken, 0u);
      ASSERT_LE(decoded.taken, line.size());
      line.erase(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(decoded.taken));
    }
  }
  line.insert(line.end(), kMaxSerialBytes, 0xFF);
  for (const auto byte : {0x02, 0x04, 0x22, 0x0A, 0x1D, 0x4D, 0x03})
    line.push_back(static_cast<std::uint8_t>(byte));
  EXPECT_EQ(drain(line).back(), kGetVersion);
}

TEST(CanCodec, IgnoresWhatIsNotPowerCubes) {
  EXPECT_FALSE(from_can({0x7E4, false, false, 2, {0x0A, 0x1D}}));
  EXPECT_FALSE(from_can({0x0C0, false, false, 2, {0x0A, 0x1D}}));  // module 0
  EXPECT_FALSE(from_can({0x0C1, false, true, 2, {}}));             // remote
  EXPECT_FALSE(from_can({0x0C1, true, false, 2, {0x0A, 0x1D}}));   // 29 bits
  EXPECT_FALSE(from_can({0x0C1, false, false, 0, {}}));
}

TEST(SlcanCodec, KnowsTheAdaptersCommandsAndRefusesOthers) {
  using Kind = SlcanDecoded::Kind;
  const auto kind = [](const std::string& line) {
    const Bytes bytes(line.begin(), line.end());
    const auto decoded = decode_slcan(bytes);
    EXPECT_EQ(decoded.taken, bytes.size());
    return decoded.progress == Progress::kComplete ? std::optional(decoded.kind) : std::nullopt;
  };
  EXPECT_EQ(kind("O\r"), Kind::kOpen);
  EXPECT_EQ(kind("S6\r"), Kind::kSet);
  EXPECT_EQ(kind("V\r"), Kind::kVersion);
  EXPECT_EQ(kind("\r"), Kind::kSet);
  EXPECT_EQ(kind("t0C120A1D1234\r"), Kind::kFrame);  // with a stamp
  for (const char* wrong : {"t0C1\r", "t0C190A1D\r", "t0C120A1\r", "t0C120A1G\r", "tFFF0\r", "x\r"})
    EXPECT_EQ(kind(wrong), std::nullopt) << wrong;
  EXPECT_EQ(decode_slcan(Bytes(kMaxSlcanBytes, 't')).taken, kMaxSlcanBytes);  // no end in sight
}

}  // namespace
}  // namespace visum::powercube
