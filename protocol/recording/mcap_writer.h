// Writes an MCAP file from front to back: chunks, each with its CRC and the indexes of its messages, and the
// summary on close(). A chunk is compressed with zstd where that makes it smaller. What was flushed can be
// read even if close() is never called. Any one thread.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/recording/compression.h"
#include "protocol/recording/crc32.h"
#include "protocol/recording/mcap.h"

namespace visum::recording {

class McapWriter {
 public:
  // Appends bytes to the file. It throws if it cannot; the writer must not be used after that.
  using Sink = std::function<void(Bytes)>;
  static constexpr std::size_t kChunkBytes = 256u << 10;  // a chunk ends when it has so many bytes
  static constexpr std::size_t kPieceBytes = 16u << 10;   // and it is compressed so many at a time
  // So that a chunk with one such message can still be read.
  static constexpr std::size_t kMaxMessageBytes = kMaxRecordBytes - 2 * kChunkBytes;

  enum class Chunks { kCompressed, kPlain };

  McapWriter(Sink sink, std::string_view library, Chunks chunks = Chunks::kCompressed);

  std::uint16_t add_schema(std::string_view name, std::string_view encoding, Bytes data);
  std::uint16_t add_channel(std::string_view topic, std::uint16_t schema, std::string_view encoding);
  // `log_time_ns` must never go back. Throws std::length_error if `data` is longer than kMaxMessageBytes.
  void write(std::uint16_t channel, std::uint64_t log_time_ns, std::uint64_t publish_time_ns, Bytes data);
  // The same in two calls, without a copy of the message: its bytes are put where begin_message() says, then
  // end_message() is the next call.
  std::span<std::byte> begin_message(std::uint16_t channel, std::uint64_t log_time_ns,
                                     std::uint64_t publish_time_ns, std::size_t size);
  void end_message();
  void attach(const Attachment& attachment);  // as a record of its own, outside of chunks
  void flush();                               // ends the chunk, if it holds anything
  void close();                               // writes the summary and the end; the last call

 private:
  struct ChunkIndex {
    std::uint64_t from_ns, until_ns, start, length, index_length, bytes, stored_bytes;
    std::string_view compression;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> message_indexes;  // channel, place in the file
  };
  struct AttachmentIndex {
    std::uint64_t start, length, size;
    std::string name, media_type;
  };

  void put(Bytes bytes);
  void put_record(Op op, const std::vector<std::byte>& content);
  Bytes take_piece();  // of the chunk: what was not compressed yet
  void put_chunk();
  void put_message_indexes(ChunkIndex& chunk);
  void put_summary();
  void put_chunk_index(const ChunkIndex& chunk);
  void put_attachment_index(const AttachmentIndex& attachment);
  void put_statistics();

  Sink sink_;
  Crc32 crc_;  // of the data section, then of the summary
  std::uint64_t place_ = 0;
  const Chunks how_;
  std::vector<std::byte> chunk_, content_;
  Compressor compressor_;
  Crc32 chunk_crc_;         // of its first `packed_` bytes,
  std::size_t packed_ = 0;  // which the compressor has
  std::uint64_t chunk_from_ns_ = 0;
  // The current chunk's, by the channel's number - 1: each message's log time and place in the chunk.
  std::vector<std::vector<std::byte>> indexes_;
  std::uint64_t chunk_messages_ = 0;
  std::vector<std::byte> schemas_, channels_;       // their records, repeated in the summary
  std::vector<std::uint32_t> messages_by_channel_;  // by the channel's number - 1
  std::vector<ChunkIndex> chunks_;
  std::vector<AttachmentIndex> attachments_;
  std::uint16_t schema_count_ = 0;
  std::uint64_t messages_ = 0, from_ns_ = 0, until_ns_ = 0;
};

}  // namespace visum::recording
