// The file format: reading returns what was written, and never anything else.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "protocol/recording/compression.h"
#include "protocol/recording/mcap_reader.h"
#include "protocol/recording/mcap_writer.h"

namespace visum::recording {
namespace {

struct Read {
  std::vector<std::string> texts;  // "topic sequence time text"
  std::vector<std::string> attachments;
  std::string damage;
};

std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Read read(const std::string& file) {
  std::istringstream in(file);
  McapReader reader(in);
  Read all;
  for (auto item = reader.next(); !std::holds_alternative<McapReader::End>(item); item = reader.next()) {
    if (const auto* attachment = std::get_if<Attachment>(&item))
      all.attachments.push_back(attachment->name + " " + text_of(attachment->data));
    if (const auto* message = std::get_if<Message>(&item))
      all.texts.push_back(reader.channel(message->channel).topic + " " + std::to_string(message->sequence) +
                          " " + std::to_string(message->log_time_ns) + " " + text_of(message->data));
  }
  all.damage = reader.damage();
  return all;
}

// Three chunks of some messages in two channels, and an attachment.
std::string small_file(bool closed = true) {
  std::string file;
  McapWriter writer([&](Bytes bytes) { file += text_of(bytes); }, "test");
  writer.attach({"scene.yaml", "text/plain", bytes_of("visum: 1")});
  const auto schema = writer.add_schema("a.Message", "protobuf", bytes_of("descriptors"));
  const auto first = writer.add_channel("/first", schema, "protobuf");
  const auto second = writer.add_channel("/second", schema, "protobuf");
  for (std::uint64_t i = 0; i < 9; ++i) {
    writer.write(i % 3 == 2 ? second : first, 1000 * i, 1000 * i, bytes_of("message " + std::to_string(i)));
    if (i % 3 == 2) writer.flush();
  }
  if (closed) writer.close();
  return file;
}

std::vector<std::string> first_of(const std::vector<std::string>& all, std::size_t count) {
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)};
}

TEST(Mcap, WhatIsWrittenIsRead) {
  const auto all = read(small_file());
  EXPECT_EQ(all.damage, "");
  EXPECT_EQ(all.attachments, std::vector<std::string>{"scene.yaml visum: 1"});
  ASSERT_EQ(all.texts.size(), 9u);
  EXPECT_EQ(all.texts[0], "/first 0 0 message 0");
  EXPECT_EQ(all.texts[2], "/second 0 2000 message 2");
  EXPECT_EQ(all.texts[8], "/second 2 8000 message 8");
}

TEST(Mcap, AChunkEndsWhenItIsFull) {
  std::string file;
  McapWriter writer([&](Bytes bytes) { file += text_of(bytes); }, "test", McapWriter::Chunks::kPlain);
  const auto channel = writer.add_channel("/big", writer.add_schema("a", "", {}), "");
  const std::string big(300'000, 'x');
  for (int i = 0; i < 10; ++i) writer.write(channel, 0, 0, bytes_of(big));
  EXPECT_GT(file.size(), 2u << 20) << "nobody asked for a flush";
  writer.close();
  EXPECT_EQ(read(file).texts.size(), 10u);
}

std::string big_file(McapWriter::Chunks chunks) {
  std::string file;
  McapWriter writer([&](Bytes bytes) { file += text_of(bytes); }, "test", chunks);
  const auto channel = writer.add_channel("/big", writer.add_schema("a", "", {}), "");
  for (int i = 0; i < 1000; ++i) writer.write(channel, 0, 0, bytes_of("message " + std::to_string(i)));
  writer.close();
  return file;
}

TEST(Mcap, CompressedAndPlainChunksHoldTheSame) {
  const auto packed = big_file(McapWriter::Chunks::kCompressed), plain = big_file(McapWriter::Chunks::kPlain);
  EXPECT_EQ(plain.find("zstd"), std::string::npos) << "as files of Visum 0.2 are";
  EXPECT_NE(packed.find("zstd"), std::string::npos);
  EXPECT_LT(packed.size(), plain.size() / 2);
  const auto from_packed = read(packed), from_plain = read(plain);
  EXPECT_EQ(from_packed.damage, "");
  EXPECT_EQ(from_plain.damage, "");
  ASSERT_EQ(from_packed.texts.size(), 1000u);
  EXPECT_EQ(from_packed.texts, from_plain.texts);
}

// Several chunks, each with many pieces: text, then bytes that cannot be packed, which stay as they are.
std::string long_file() {
  std::string file;
  McapWriter writer([&](Bytes bytes) { file += text_of(bytes); }, "test");
  const auto channel = writer.add_channel("/long", writer.add_schema("a", "", {}), "");
  std::uint32_t random = 1;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    std::string text(700, 'x');
    for (std::size_t k = i % 7; k < text.size(); k += i < 3000 ? 9 : 1)
      text[k] = static_cast<char>((random = random * 1'664'525u + 1'013'904'223u) >> 24);
    writer.write(channel, i, i, bytes_of(text));
  }
  writer.write(channel, 4000, 4000, bytes_of(std::string(3u << 20, 'y')));
  writer.close();
  return file;
}

TEST(Mcap, AChunkMayBePackedInManyPieces) {
  const auto file = long_file();
  EXPECT_EQ(file, long_file());
  const auto all = read(file);
  EXPECT_EQ(all.damage, "");
  ASSERT_EQ(all.texts.size(), 4001u);
  EXPECT_EQ(all.texts[2999].size(), all.texts[3000].size());
  EXPECT_EQ(all.texts[4000], "/long 4000 4000 " + std::string(3u << 20, 'y'));
  constexpr std::size_t kUnpackable = 1000 * 700, kAll = 4000 * 700 + (3u << 20);
  EXPECT_GT(file.size(), kUnpackable);
  EXPECT_LT(file.size(), kUnpackable + (kAll - kUnpackable) / 4);
}

TEST(Mcap, AChunkThatIsPackedInAnotherWayIsRefused) {
  auto file = big_file(McapWriter::Chunks::kCompressed);
  file.replace(file.find("zstd"), 4, "lz4!");
  EXPECT_NE(read(file).damage.find("something else than zstd"), std::string::npos) << read(file).damage;
}

// The length when unpacked stands 12 bytes before the name's length: a chunk that claims to become huge.
TEST(Mcap, AChunkThatClaimsAnotherLengthThanItHasIsRefused) {
  for (const char claim : {'\x01', '\x7f'}) {
    auto file = big_file(McapWriter::Chunks::kCompressed);
    const auto length = file.find("zstd") - 4 - 4 - 8;
    file[length + 3] = claim;  // 16 MiB more, or 2 GiB
    const auto all = read(file);
    EXPECT_TRUE(all.texts.empty());
    EXPECT_NE(all.damage, "");
  }
}

TEST(Mcap, AChunkThatClaimsMoreThanItCanHoldTakesNoMemory) {
  Compressor compressor;
  const auto packed = compressor.finish(bytes_of(std::string(1000, 'x')));
  std::vector<std::byte> to;
  EXPECT_FALSE(decompress(packed, 64u << 20, to));
  EXPECT_EQ(to.capacity(), 0u);
  EXPECT_TRUE(decompress(packed, 1000, to));
}

TEST(Mcap, WithoutItsEndAFileReadsUpToItsLastChunk) {
  const auto all = read(small_file(false));
  EXPECT_EQ(all.texts.size(), 9u);
  EXPECT_NE(all.damage.find("its writer was cut short"), std::string::npos) << all.damage;
}

TEST(Mcap, CutAtEveryByteItReadsUpToItsLastWholeChunk) {
  const auto file = small_file();
  const auto whole = read(file).texts;
  std::size_t most = 0;
  for (std::size_t size = 0; size < file.size(); ++size) {
    const auto all = read(file.substr(0, size));
    ASSERT_NE(all.damage, "") << size;
    ASSERT_LE(all.texts.size(), whole.size());
    ASSERT_GE(all.texts.size(), most) << "more bytes never give fewer messages";
    ASSERT_EQ(all.texts, first_of(whole, all.texts.size())) << size;
    most = all.texts.size();
  }
  EXPECT_EQ(most, whole.size());
}

TEST(Mcap, EveryFlippedBitIsNoticedAndNoMessageIsChanged) {
  const auto file = small_file();
  const auto whole = read(file).texts;
  for (std::size_t bit = 0; bit < file.size() * 8; ++bit) {
    auto flipped = file;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
    const auto all = read(flipped);
    ASSERT_NE(all.damage, "") << "bit " << bit;
    for (const auto& text : all.texts)
      ASSERT_TRUE(std::ranges::find(whole, text) != whole.end()) << "bit " << bit << ": " << text;
  }
}

TEST(Mcap, LengthsBeyondTheFileAllocateNothing) {
  auto file = small_file();
  for (std::size_t i = 0; i < 8; ++i) file[9 + i] = static_cast<char>(0xFF);  // the header's length
  EXPECT_NE(read(file).damage.find("too long"), std::string::npos);
  EXPECT_EQ(read("no such thing at all").damage, "byte 0: this is no MCAP file");
  EXPECT_EQ(read("").damage, "byte 0: this is no MCAP file");
}

// Its bytes are not looked at.
TEST(Mcap, AMessageThatNoReaderWouldTakeIsNotWritten) {
  McapWriter writer([](Bytes) {}, "test");
  const auto channel = writer.add_channel("/x", 0, "");
  constexpr auto kTooLong = McapWriter::kMaxMessageBytes + 1;
  const auto bytes = std::make_unique_for_overwrite<std::byte[]>(kTooLong);
  EXPECT_THROW(writer.write(channel, 0, 0, {bytes.get(), kTooLong}), std::length_error);
}

TEST(Crc32, IsTheOneOfTheStandards) {
  EXPECT_EQ(crc32(bytes_of("123456789")), 0xCBF43926u);  // the check value of CRC-32/ISO-HDLC
  EXPECT_EQ(crc32({}), 0u);
}

TEST(Crc32, IsTheSameInPieces) {
  Crc32 crc;
  for (const std::string_view piece : {"1234", "", "5", "6789"}) crc.add(bytes_of(piece));
  crc.add({});  // no bytes, and a null pointer
  EXPECT_EQ(crc.value(), 0xCBF43926u);
}

}  // namespace
}  // namespace visum::recording
