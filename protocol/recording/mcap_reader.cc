#include "protocol/recording/mcap_reader.h"

#include <algorithm>
#include <utility>

#include "protocol/recording/compression.h"

namespace visum::recording {
namespace {

// Reads a message from a record. Returns false if the record is too short.
bool read_message(Bytes content, Message& message) {
  LittleReader from(content);
  message.channel = from.number<std::uint16_t>();
  message.sequence = from.number<std::uint32_t>();
  message.log_time_ns = from.number<std::uint64_t>();
  message.publish_time_ns = from.number<std::uint64_t>();
  if (!from.complete()) return false;
  message.data = from.rest();
  return true;
}

bool is_magic(const std::vector<std::byte>& bytes) {
  return std::ranges::equal(bytes, std::as_bytes(std::span(kMcapMagic)));
}

}  // namespace

McapReader::McapReader(std::istream& in) : in_(in) {
  in_.seekg(0, std::ios::end);
  const auto end = in_.tellg();
  in_.seekg(0);
  if (!in_ || end < 0) {
    fail("cannot be read");
    return;
  }
  size_ = static_cast<std::uint64_t>(end);
  if (!read(kMcapMagic.size(), record_) || !is_magic(record_)) fail("this is no MCAP file");
  crc_.add(record_);
}

bool McapReader::fail(const std::string& what) {
  damage_ = "byte " + std::to_string(record_at_) + ": " + what;
  ended_ = true;
  return false;
}

bool McapReader::read(std::uint64_t size, std::vector<std::byte>& to) {
  if (size > size_ - place_) return fail("the file is cut short");
  to.resize(static_cast<std::size_t>(size));
  in_.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(size));
  if (in_.gcount() != static_cast<std::streamsize>(size)) return fail("cannot be read");
  place_ += size;
  return true;
}

bool McapReader::read_record(Record& record) {
  record_at_ = place_;
  if (place_ == size_) return fail("the file ends without its summary: its writer was cut short");
  std::vector<std::byte> head;
  if (!read(kRecordHeadBytes, head)) return false;
  LittleReader from(head);
  record.op = static_cast<Op>(from.number<std::uint8_t>());
  const auto length = from.number<std::uint64_t>();
  if (length > kMaxRecordBytes) return fail("a record of " + std::to_string(length) + " bytes is too long");
  if (!read(length, record_)) return false;
  record.content = record_;
  // Two records hold a CRC of everything before them: DataEnd, and the footer (of itself all but the CRC).
  if (record.op == Op::kDataEnd) return true;
  crc_.add(head);
  crc_.add(record.op == Op::kFooter
               ? record.content.first(record_.size() - std::min<std::size_t>(4, record_.size()))
               : record.content);
  return true;
}

McapReader::Place McapReader::place() const {
  if (in_chunk_.at_end()) return {place_, 0};
  return {chunk_at_, in_chunk_.left().size()};
}

void McapReader::go_to(const Place& place) {
  went_ = true;
  ended_ = false;
  damage_.clear();
  summary_at_ = 0;
  in_.clear();
  in_chunk_ = LittleReader({});
  in_.seekg(static_cast<std::streamoff>(place.record));
  place_ = place.record;
  Record record{};
  if (place.left == 0 || !read_record(record) || !take(record)) return;
  const auto content = in_chunk_.left();
  if (place.left <= content.size()) in_chunk_ = LittleReader(content.last(place.left));
}

std::variant<McapReader::End, Attachment, Message> McapReader::next() {
  item_ = End{};
  while (!ended_ && std::holds_alternative<End>(item_)) {
    Record record{};
    if (in_chunk_.at_end()) {
      if (!read_record(record) || !take(record)) break;
      continue;
    }
    record.op = static_cast<Op>(in_chunk_.number<std::uint8_t>());
    record.content = in_chunk_.raw(in_chunk_.number<std::uint64_t>());
    if (!in_chunk_.complete() || !take_in_chunk(record)) fail("a chunk holds something that is not a record");
  }
  if (ended_) return End{};
  return item_;
}

// Handles a record outside of chunks. Unknown kinds are skipped, as the format demands.
bool McapReader::take(const Record& record) {
  switch (record.op) {
    case Op::kChunk:
      return enter_chunk(record.content);
    case Op::kAttachment: {
      Attachment attachment;
      if (!read_attachment(record.content, attachment)) return fail("an attachment's CRC is wrong");
      item_ = std::move(attachment);
      return true;
    }
    case Op::kMessage:
      return fail("a message outside of a chunk, where no CRC covers it");
    case Op::kDataEnd:
      return take_data_end(record.content);
    case Op::kFooter:
      return finish(record.content);
    default:
      return true;
  }
}

bool McapReader::take_in_chunk(const Record& record) {
  if (record.op == Op::kChannel) return take_channel(record.content);
  if (record.op != Op::kMessage) return true;
  Message message;
  if (!read_message(record.content, message) || !channels_.contains(message.channel)) return false;
  item_ = message;
  return true;
}

bool McapReader::take_channel(Bytes content) {
  LittleReader from(content);
  Channel channel;
  channel.id = from.number<std::uint16_t>();
  channel.schema = from.number<std::uint16_t>();
  channel.topic = from.text();
  channel.encoding = from.text();
  if (!from.complete()) return false;
  channels_[channel.id] = std::move(channel);
  return true;
}

// Checks the chunk as a whole; next() then reads the records in it.
bool McapReader::enter_chunk(Bytes content) {
  LittleReader from(content);
  from.raw(8 + 8);  // earliest and latest time of its messages; each message has its own
  const auto size = from.number<std::uint64_t>();
  const auto crc = from.number<std::uint32_t>();
  const std::string compression(from.text());
  const auto records = from.raw(from.number<std::uint64_t>());
  if (!from.complete() || !from.at_end()) return fail("a chunk's lengths contradict each other");
  chunk_at_ = record_at_;
  if (compression.empty()) return enter_records(records, size, crc, record_);
  if (compression != kZstd) return fail("a chunk is compressed with something else than zstd");
  if (size > kMaxRecordBytes)
    return fail("a chunk of " + std::to_string(size) + " bytes when unpacked is too long");
  if (!decompress(records, static_cast<std::size_t>(size), unpacked_))
    return fail("a compressed chunk is damaged");
  return enter_records(unpacked_, size, crc, unpacked_);
}

// `records` are bytes of `owner`, which are kept.
bool McapReader::enter_records(Bytes records, std::uint64_t size, std::uint32_t crc,
                               std::vector<std::byte>& owner) {
  if (records.size() != size || crc32(records) != crc) return fail("a chunk's CRC is wrong");
  std::swap(chunk_, owner);  // views into the chunk stay valid: its bytes do not move
  in_chunk_ = LittleReader(records);
  return true;
}

bool McapReader::read_attachment(Bytes content, Attachment& attachment) {
  LittleReader from(content);
  from.raw(8 + 8);  // log time and creation time
  attachment.name = from.text();
  attachment.media_type = from.text();
  attachment.data = from.raw(from.number<std::uint64_t>());
  const auto crc = from.number<std::uint32_t>();
  return from.complete() && from.at_end() && crc32(content.first(content.size() - 4)) == crc;
}

bool McapReader::take_data_end(Bytes content) {
  LittleReader from(content);
  const auto crc = from.number<std::uint32_t>();
  if (!from.complete()) return fail("the record at the end of the data is malformed");
  if (crc != 0 && crc != crc_.value() && !went_) return fail("the CRC of the data is wrong");
  summary_at_ = place_;
  crc_ = {};
  return true;
}

bool McapReader::finish(Bytes footer) {
  ended_ = true;
  LittleReader from(footer);
  const auto summary = from.number<std::uint64_t>();
  from.number<std::uint64_t>();  // where the index of the summary begins
  const auto crc = from.number<std::uint32_t>();
  if (!from.complete() || !from.at_end() || summary_at_ == 0) return fail("the footer is malformed");
  if (summary != 0 && summary != summary_at_) return fail("the summary is not where the footer says");
  if (crc != 0 && crc != crc_.value()) return fail("the summary's CRC is wrong");
  std::vector<std::byte> magic;
  if (!read(kMcapMagic.size(), magic)) return false;
  return (is_magic(magic) && place_ == size_) || fail("something follows where the file should end");
}

}  // namespace visum::recording
