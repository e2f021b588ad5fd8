// Reads an MCAP file front to back, without its index: a file that was cut short reads up to its last whole
// record. No chunk is believed whose CRC is wrong, and none that is compressed. Never throws, and never
// allocates more than the file is long. Any one thread.
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
  // `in`: a file, which has to outlive the reader.
  explicit McapReader(std::istream& in);

  struct End {};
  // What comes next. After the End, damage() tells whether it was the file's.
  std::variant<End, Attachment, Message> next();

  // Where the next record will be read, to come back to it: within one reader, of a place that it has passed.
  struct Place {
    std::uint64_t record = 0;  // where the chunk begins that holds it
    std::size_t left = 0;      // bytes of that chunk from there on; 0: the record stands outside of chunks
  };
  Place place() const;
  // Reads on from there. What was passed once is known to be whole: the CRC over the whole file is not looked
  // at any more.
  void go_to(const Place& place);

  // The channel of a message that was read.
  const Channel& channel(std::uint16_t id) const { return channels_.at(id); }

  // Why nothing more was read, and where: "byte 1234: cut short"; empty: the file is whole.
  const std::string& damage() const { return damage_; }

 private:
  struct Record {
    Op op;
    Bytes content;
  };
  bool read(std::uint64_t size, std::vector<std::byte>& to);
  bool read_record(Record& record);
  bool enter_chunk(Bytes content);
  bool read_attachment(Bytes content, Attachment& attachment);
  bool take(const Record& record);
  bool take_in_chunk(const Record& record);
  bool take_channel(Bytes content);
  bool take_data_end(Bytes content);
  bool finish(Bytes footer);
  bool fail(const std::string& what);

  std::istream& in_;
  std::uint64_t size_ = 0, place_ = 0;
  std::uint64_t chunk_at_ = 0;    // where the chunk in hand begins
  bool went_ = false;             // elsewhere: crc_ tells nothing
  std::uint64_t record_at_ = 0;   // where the record in hand begins
  Crc32 crc_;                     // of the data section, then of the summary
  std::uint64_t summary_at_ = 0;  // 0: still in the data section
  std::vector<std::byte> record_, chunk_;
  LittleReader in_chunk_{{}};
  std::map<std::uint16_t, Channel> channels_;
  std::variant<End, Attachment, Message> item_;
  bool ended_ = false;
  std::string damage_;
};

}  // namespace visum::recording
