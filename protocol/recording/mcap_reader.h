// Reads an MCAP file from front to back, without its index. So a file that was cut short can be read up to
// its last whole record. Chunks are plain or compressed with zstd; one with a wrong CRC, or compressed in
// another way, is refused. Allocates no more memory than the file is long and its largest chunk is when
// unpacked, at most kMaxRecordBytes. Owned by its user; any one thread.
#pragma once

#include <cstdint>
#include <istream>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "protocol/recording/crc32.h"
#include "protocol/recording/mcap.h"

namespace visum::recording {

class McapReader {
 public:
  // `in` is a file; it must outlive the reader.
  explicit McapReader(std::istream& in);

  struct End {};
  // Reads the next attachment or message. After End, damage() says if the file was damaged.
  std::variant<End, Attachment, Message> next();

  // A place to come back to with go_to(): where the next record begins. Valid within one reader, for places
  // that it has passed.
  struct Place {
    std::uint64_t record = 0;  // where the chunk with the record begins
    std::size_t left = 0;      // bytes of that chunk from the record on; 0: the record is not in a chunk
  };
  Place place() const;
  // Continues reading from there. The CRC over the whole file is not checked any more: what was passed once
  // is known to be whole.
  void go_to(const Place& place);

  // The channel of a message that was read before.
  const Channel& channel(std::uint16_t id) const { return channels_.at(id); }

  // The reason and the place where reading stopped: "byte 1234: cut short". Empty if the file is whole.
  const std::string& damage() const { return damage_; }

 private:
  struct Record {
    Op op;
    Bytes content;
  };
  // These return false at the end of the file or at damage.
  bool read(std::uint64_t size, std::vector<std::byte>& to);
  bool read_record(Record& record);
  // Checks a chunk's CRC and goes on with the records in it.
  bool enter_chunk(Bytes content);
  bool enter_records(Bytes records, std::uint64_t size, std::uint32_t crc, std::vector<std::byte>& owner);
  bool read_attachment(Bytes content, Attachment& attachment);
  // Handle a record outside of chunks, and one inside a chunk.
  bool take(const Record& record);
  bool take_in_chunk(const Record& record);
  bool take_channel(Bytes content);
  bool take_data_end(Bytes content);
  bool finish(Bytes footer);
  bool fail(const std::string& what);

  std::istream& in_;
  std::uint64_t size_ = 0, place_ = 0;
  std::uint64_t chunk_at_ = 0;    // where the current chunk begins
  bool went_ = false;             // go_to() was called, so crc_ is not the file's
  std::uint64_t record_at_ = 0;   // where the current record begins
  Crc32 crc_;                     // of the data section, then of the summary
  std::uint64_t summary_at_ = 0;  // 0: still in the data section
  std::vector<std::byte> record_, chunk_, unpacked_;
  LittleReader in_chunk_{{}};
  std::map<std::uint16_t, Channel> channels_;
  std::variant<End, Attachment, Message> item_;
  bool ended_ = false;
  std::string damage_;
};

}  // namespace visum::recording
