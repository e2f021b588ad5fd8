// Writes an MCAP file front to back: chunks without compression, each with its CRC and the indexes of its
// messages; on close() the summary. What was flushed can be read even if close() never comes. Any one thread.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/recording/crc32.h"
#include "protocol/recording/mcap.h"

namespace visum::recording {

class McapWriter {
 public:
  // Takes bytes that go to the end of the file; throws where it cannot. The writer is lost then.
  using Sink = std::function<void(Bytes)>;
  static constexpr std::size_t kChunkBytes = 1u << 20;  // a chunk that has so many ends
  static constexpr std::size_t kMaxMessageBytes =
      kMaxRecordBytes - 2 * kChunkBytes;  // in a chunk that is read

  McapWriter(Sink sink, std::string_view library);

  std::uint16_t add_schema(std::string_view name, std::string_view encoding, Bytes data);
  std::uint16_t add_channel(std::string_view topic, std::uint16_t schema, std::string_view encoding);
  // `log_time_ns` never goes back. Throws std::length_error where `data` is longer than a message may be.
  void write(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns, Bytes data);
  void attach(const Attachment& attachment);  // a file of its own, outside of chunks
  void flush();                               // ends the chunk, if there is something in it
  void close();                               // the summary and the end; nothing may be written after it

 private:
  using MessageIndex = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  // log time, place in the chunk
  struct ChunkIndex {
    std::uint64_t from_ns, until_ns, start, length, index_length, bytes;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> message_indexes;  // channel, place in the file
  };
  struct AttachmentIndex {
    std::uint64_t start, length, size;
    std::string name, media_type;
  };

  void put(Bytes bytes);
  void put_record(Op op, const std::vector<std::byte>& content);
  void put_chunk();
  void put_message_indexes(ChunkIndex& chunk);
  void put_summary();
  void put_chunk_index(const ChunkIndex& chunk);
  void put_attachment_index(const AttachmentIndex& attachment);
  void put_statistics();

  Sink sink_;
  Crc32 crc_;  // of the data section, then of the summary
  std::uint64_t place_ = 0;
  std::vector<std::byte> chunk_, content_;
  std::uint64_t chunk_from_ns_ = 0;
  std::map<std::uint16_t, MessageIndex> indexes_;   // of the chunk, by channel
  std::vector<std::byte> schemas_, channels_;       // their records, for the summary
  std::vector<std::uint32_t> messages_by_channel_;  // by channel's number - 1
  std::vector<ChunkIndex> chunks_;
  std::vector<AttachmentIndex> attachments_;
  std::uint16_t schema_count_ = 0;
  std::uint64_t messages_ = 0, from_ns_ = 0, until_ns_ = 0;
};

}  // namespace visum::recording
