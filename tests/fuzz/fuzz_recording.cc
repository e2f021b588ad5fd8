// Any bytes as a recording's file, as the records of a chunk with a correct CRC, and as its messages. What
// the writer wrote is read back unchanged.
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "protocol/recording/mcap_reader.h"
#include "protocol/recording/mcap_writer.h"
#include "protocol/recording/records.h"

namespace {

using namespace visum::recording;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

template <typename Kind>
void into(Kind&& kind, Bytes bytes) {
  if (!decode(bytes, kind)) return;
  std::vector<std::byte> first, second;
  encode(kind, first);
  std::decay_t<Kind> again;
  if (!decode(first, again)) fail("a message that was encoded here is refused");
  encode(again, second);
  if (first != second) fail("a message changed on the way");
}

void into_the_messages(Bytes bytes) {
  into(Header{}, bytes);
  into(State{}, bytes);
  into(visum::protocol::PartDescription{}, bytes);
  visum::protocol::PartSample sample;
  decode(bytes, sample);
  TickMessage tick;
  tick.decode(bytes);
  InputMessage input;
  if (!input.decode(bytes)) return;
  std::vector<std::byte> encoded;
  encode(input.input, encoded);
  InputMessage again;
  if (!again.decode(encoded)) fail("an input that was encoded here is refused");
}

// Returns how many messages and attachments the reader returned.
std::size_t into_the_reader(const std::string& file) {
  std::istringstream in(file);
  McapReader reader(in);
  std::size_t count = 0;
  for (auto item = reader.next(); !std::holds_alternative<McapReader::End>(item); item = reader.next()) {
    ++count;
    if (const auto* message = std::get_if<Message>(&item)) {
      if (reader.channel(message->channel).id != message->channel) fail("a message of no channel");
      into_the_messages(message->data);
    }
  }
  return count;
}

template <typename T>
void put(std::string& to, T value) {
  for (std::size_t i = 0; i < sizeof value; ++i) to += static_cast<char>(value >> (8 * i));
}

void as_a_chunk(const std::string& records) {
  std::string chunk;
  put<std::uint64_t>(chunk, 0);
  put<std::uint64_t>(chunk, 0);
  put<std::uint64_t>(chunk, records.size());
  put<std::uint32_t>(chunk, crc32(std::as_bytes(std::span(records))));
  put<std::uint32_t>(chunk, 0);  // no compression
  put<std::uint64_t>(chunk, records.size());
  std::string file(kMcapMagic.begin(), kMcapMagic.end());
  put<std::uint8_t>(file, static_cast<std::uint8_t>(Op::kChunk));
  put<std::uint64_t>(file, chunk.size() + records.size());
  into_the_reader(file + chunk + records);
}

void through_a_file(Bytes bytes) {
  std::string file;
  McapWriter writer(
      [&](Bytes piece) { file.append(reinterpret_cast<const char*>(piece.data()), piece.size()); }, "fuzz");
  writer.attach({"a", "b", bytes});
  const auto channel = writer.add_channel("/c", writer.add_schema("s", "protobuf", bytes), "protobuf");
  writer.write(channel, 1, 2, bytes);
  writer.close();
  if (into_the_reader(file) != 2) fail("what was written does not come back");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  into_the_reader(bytes);
  as_a_chunk(bytes);
  into_the_messages(std::as_bytes(std::span(data, size)));
  through_a_file(std::as_bytes(std::span(data, size)));
  return 0;
}
