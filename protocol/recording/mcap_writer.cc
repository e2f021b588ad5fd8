#include "protocol/recording/mcap_writer.h"

#include <algorithm>
#include <stdexcept>

namespace visum::recording {
namespace {

void append_head(std::vector<std::byte>& out, Op op, std::size_t content_size) {
  LittleWriter to(out);
  to.number(static_cast<std::uint8_t>(op));
  to.number(static_cast<std::uint64_t>(content_size));
}

void append_record(std::vector<std::byte>& out, Op op, const std::vector<std::byte>& content) {
  append_head(out, op, content.size());
  LittleWriter(out).raw(content);
}

}  // namespace

McapWriter::McapWriter(Sink sink, std::string_view library, Chunks chunks)
    : sink_(std::move(sink)), how_(chunks) {
  chunk_.reserve(kChunkBytes + (kChunkBytes >> 2));
  put(std::as_bytes(std::span(kMcapMagic)));
  std::vector<std::byte> header;
  LittleWriter to(header);
  to.text("");  // no profile
  to.text(library);
  put_record(Op::kHeader, header);
}

// Everything that goes into the file passes here, so that place and CRC are right.
void McapWriter::put(Bytes bytes) {
  crc_.add(bytes);
  sink_(bytes);
  place_ += bytes.size();
}

void McapWriter::put_record(Op op, const std::vector<std::byte>& content) {
  std::vector<std::byte> record;
  record.reserve(kRecordHeadBytes + content.size());
  append_record(record, op, content);
  put(record);
}

// Schemas and channels stand in the chunk before their messages, and again in the summary.
std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding, Bytes data) {
  std::vector<std::byte> schema;
  LittleWriter to(schema);
  to.number(++schema_count_);
  to.text(name);
  to.text(encoding);
  to.number(static_cast<std::uint32_t>(data.size()));
  to.raw(data);
  append_record(chunk_, Op::kSchema, schema);
  append_record(schemas_, Op::kSchema, schema);
  return schema_count_;
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::uint16_t schema,
                                      std::string_view encoding) {
  messages_by_channel_.push_back(0);
  indexes_.emplace_back();
  const auto id = static_cast<std::uint16_t>(messages_by_channel_.size());
  std::vector<std::byte> channel;
  LittleWriter to(channel);
  to.number(id);
  to.number(schema);
  to.text(topic);
  to.text(encoding);
  to.number(std::uint32_t{0});  // no metadata
  append_record(chunk_, Op::kChannel, channel);
  append_record(channels_, Op::kChannel, channel);
  return id;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns,
                       Bytes data) {
  std::ranges::copy(data, begin_message(channel, log_time_ns, publish_time_ns, data.size()).begin());
  end_message();
}

std::span<std::byte> McapWriter::begin_message(std::uint16_t channel, std::uint64_t log_time_ns,
                                               std::uint64_t publish_time_ns, std::size_t size) {
  if (size > kMaxMessageBytes)
    throw std::length_error("a message of " + std::to_string(size >> 20) + " MiB; the longest has " +
                            std::to_string(kMaxMessageBytes >> 20));
  if (messages_++ == 0) from_ns_ = log_time_ns;
  until_ns_ = std::max(until_ns_, log_time_ns);
  if (chunk_messages_++ == 0) chunk_from_ns_ = log_time_ns;
  auto& index = indexes_[channel - 1u];
  constexpr std::size_t kEntry = 8 + 8;
  index.resize(index.size() + kEntry);
  put_number(put_number(index.data() + index.size() - kEntry, log_time_ns),
             static_cast<std::uint64_t>(chunk_.size()));
  constexpr std::size_t kHead = 2 + 4 + 8 + 8;
  const auto start = chunk_.size();
  chunk_.resize(start + kRecordHeadBytes + kHead + size);
  auto* at = put_number(chunk_.data() + start, static_cast<std::uint8_t>(Op::kMessage));
  at = put_number(at, static_cast<std::uint64_t>(kHead + size));
  at = put_number(at, channel);
  at = put_number(at, messages_by_channel_[channel - 1u]++);
  at = put_number(at, log_time_ns);
  at = put_number(at, publish_time_ns);
  return {at, size};
}

void McapWriter::end_message() {
  if (chunk_.size() >= kChunkBytes)
    put_chunk();
  else if (how_ == Chunks::kCompressed && chunk_.size() - packed_ >= kPieceBytes)
    compressor_.add(take_piece());
}

Bytes McapWriter::take_piece() {
  const auto piece = Bytes(chunk_).subspan(packed_);
  packed_ = chunk_.size();
  chunk_crc_.add(piece);
  return piece;
}

void McapWriter::attach(const Attachment& attachment) {
  std::vector<std::byte> content;
  content.reserve(64 + attachment.name.size() + attachment.data.size());
  LittleWriter to(content);
  to.number(std::uint64_t{0});  // log time: the beginning
  to.number(std::uint64_t{0});  // creation time: left out, so that equal runs give equal files
  to.text(attachment.name);
  to.text(attachment.media_type);
  to.number(static_cast<std::uint64_t>(attachment.data.size()));
  to.raw(attachment.data);
  to.number(crc32(content));
  attachments_.push_back({place_, kRecordHeadBytes + content.size(), attachment.data.size(), attachment.name,
                          attachment.media_type});
  put_record(Op::kAttachment, content);
}

void McapWriter::flush() {
  if (!chunk_.empty()) put_chunk();
}

// Writes the chunk and the indexes of its messages, and remembers it for the summary.
void McapWriter::put_chunk() {
  const auto until_ns = chunk_messages_ == 0 ? 0 : until_ns_;
  const auto piece = take_piece();
  Bytes stored = chunk_;
  std::string_view compression;
  if (how_ == Chunks::kCompressed) {
    const auto packed = compressor_.finish(piece);
    if (packed.size() < stored.size()) {
      stored = packed;
      compression = kZstd;
    }
  }
  ChunkIndex index{chunk_from_ns_, until_ns, place_, 0, 0, chunk_.size(), stored.size(), compression, {}};
  content_.clear();
  append_head(content_, Op::kChunk, 8 + 8 + 8 + 4 + 4 + compression.size() + 8 + stored.size());
  LittleWriter to(content_);
  to.number(chunk_from_ns_);
  to.number(until_ns);
  to.number(static_cast<std::uint64_t>(chunk_.size()));
  to.number(chunk_crc_.value());
  to.text(compression);
  to.number(static_cast<std::uint64_t>(stored.size()));
  put(content_);
  put(stored);
  index.length = place_ - index.start;
  put_message_indexes(index);
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_crc_ = {};
  packed_ = 0;
  chunk_messages_ = chunk_from_ns_ = 0;
}

void McapWriter::put_message_indexes(ChunkIndex& chunk) {
  content_.clear();
  for (std::size_t i = 0; i < indexes_.size(); ++i) {
    auto& entries = indexes_[i];
    if (entries.empty()) continue;
    const auto channel = static_cast<std::uint16_t>(i + 1);
    chunk.message_indexes.emplace_back(channel, place_ + content_.size());
    append_head(content_, Op::kMessageIndex, 2 + 4 + entries.size());
    LittleWriter to(content_);
    to.number(channel);
    to.number(static_cast<std::uint32_t>(entries.size()));
    to.raw(entries);
    entries.clear();
  }
  chunk.index_length = content_.size();
  put(content_);
}

void McapWriter::close() {
  flush();
  content_.clear();
  LittleWriter(content_).number(crc_.value());
  put_record(Op::kDataEnd, content_);
  put_summary();
  sink_(std::as_bytes(std::span(kMcapMagic)));
}

// The summary: records grouped by kind, where each group begins, and the footer, whose CRC covers all of it.
void McapWriter::put_summary() {
  const auto summary = place_;
  crc_ = {};
  std::vector<std::byte> offsets;
  const auto group = [&](Op op, const auto& put_group) {
    const auto start = place_;
    put_group();
    if (place_ == start) return;
    content_.clear();
    LittleWriter to(content_);
    to.number(static_cast<std::uint8_t>(op));
    to.number(start);
    to.number(place_ - start);
    append_record(offsets, Op::kSummaryOffset, content_);
  };
  group(Op::kSchema, [&] { put(schemas_); });
  group(Op::kChannel, [&] { put(channels_); });
  group(Op::kStatistics, [&] { put_statistics(); });
  group(Op::kChunkIndex, [&] {
    for (const auto& chunk : chunks_) put_chunk_index(chunk);
  });
  group(Op::kAttachmentIndex, [&] {
    for (const auto& attachment : attachments_) put_attachment_index(attachment);
  });
  const auto offsets_start = place_;
  put(offsets);
  std::vector<std::byte> footer;
  LittleWriter to(footer);
  to.number(static_cast<std::uint8_t>(Op::kFooter));
  to.number(std::uint64_t{8 + 8 + 4});
  to.number(summary);
  to.number(offsets_start);
  crc_.add(footer);
  to.number(crc_.value());
  sink_(footer);
}

void McapWriter::put_chunk_index(const ChunkIndex& chunk) {
  content_.clear();
  LittleWriter to(content_);
  to.number(chunk.from_ns);
  to.number(chunk.until_ns);
  to.number(chunk.start);
  to.number(chunk.length);
  to.number(static_cast<std::uint32_t>(chunk.message_indexes.size() * 10));
  for (const auto& [channel, place] : chunk.message_indexes) {
    to.number(channel);
    to.number(place);
  }
  to.number(chunk.index_length);
  to.text(chunk.compression);
  to.number(chunk.stored_bytes);
  to.number(chunk.bytes);
  put_record(Op::kChunkIndex, content_);
}

void McapWriter::put_attachment_index(const AttachmentIndex& attachment) {
  content_.clear();
  LittleWriter to(content_);
  to.number(attachment.start);
  to.number(attachment.length);
  to.number(std::uint64_t{0});
  to.number(std::uint64_t{0});
  to.number(attachment.size);
  to.text(attachment.name);
  to.text(attachment.media_type);
  put_record(Op::kAttachmentIndex, content_);
}

void McapWriter::put_statistics() {
  content_.clear();
  LittleWriter to(content_);
  to.number(messages_);
  to.number(schema_count_);
  to.number(static_cast<std::uint32_t>(messages_by_channel_.size()));
  to.number(static_cast<std::uint32_t>(attachments_.size()));
  to.number(std::uint32_t{0});  // metadata
  to.number(static_cast<std::uint32_t>(chunks_.size()));
  to.number(from_ns_);
  to.number(until_ns_);
  to.number(static_cast<std::uint32_t>(messages_by_channel_.size() * 10));
  for (std::size_t i = 0; i < messages_by_channel_.size(); ++i) {
    to.number(static_cast<std::uint16_t>(i + 1));
    to.number(static_cast<std::uint64_t>(messages_by_channel_[i]));
  }
  put_record(Op::kStatistics, content_);
}

}  // namespace visum::recording
