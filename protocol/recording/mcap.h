// The elements of an MCAP file (version 0 of MCAP's own specification), shared by writer and reader. A file
// is the magic, a header, records, and an index at the end. A record is one byte of kind, eight bytes of
// length, and its content. Messages stand in chunks, each with a CRC.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "protocol/recording/little_endian.h"

namespace visum::recording {

inline constexpr std::array<std::uint8_t, 8> kMcapMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kRecordHeadBytes = 9;
inline constexpr std::uint64_t kMaxRecordBytes = 192u << 20;  // a scene's largest mesh fits

enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;
  std::string topic;
  std::string encoding;  // of its messages, "protobuf"
};

// A message as it stands in a file. `data` is valid until the next message is read.
struct Message {
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;     // counts the messages of the channel, from 0
  std::uint64_t log_time_ns = 0;  // never goes back within a file
  std::uint64_t publish_time_ns = 0;
  Bytes data;
};

// A file that is stored in the recording.
struct Attachment {
  std::string name;
  std::string media_type;
  Bytes data;
};

}  // namespace visum::recording
