// Reads a recording front to back: first what its world was made of, then what happened in it. A record is
// given out only if its CRC is right and no record of its channel is missing before it. Any one thread.
// Damage is no exception: reading ends there, and damage() says why.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "protocol/config/read_file.h"
#include "protocol/recording/mcap_reader.h"
#include "protocol/recording/records.h"

namespace visum::recording {

class RecordingFile {
 public:
  // Reads up to the header. Throws config::ConfigError where there is none, or where a file of the scene is
  // missing or differs from what the header says.
  explicit RecordingFile(const std::filesystem::path& file);

  const Header& header() const { return header_; }
  config::Files take_files() { return std::move(files_); }  // the scene's; only once

  struct End {};
  // The next record; its pointer is valid until the next call. After the End, damage() tells why it ended.
  using Item = std::variant<End, const TimedInput*, const Tick*, const protocol::PartSample*,
                            const protocol::PartDescription*, const State*, const LogLine*>;
  Item next();

  // A place in the file, to come back to it later.
  struct Place {
    McapReader::Place place;
    std::map<std::uint16_t, std::uint32_t> sequences;
  };
  Place place() const { return {reader_.place(), sequences_}; }  // of the next item
  Place place_of_last() const;                                   // of the item that next() returned last
  void go_to(const Place& place);

  // Why reading ended, and where; empty: the file is complete.
  const std::string& damage() const { return damage_.empty() ? reader_.damage() : damage_; }

 private:
  // Decodes a message by its channel. Returns End where no reader needs it, or where it is damaged.
  Item take(const Message& message);
  template <typename Kind>
  Item take_as(Kind& kind, const Message& message);
  // True if this is the channel's next message, so that none is missing.
  bool in_sequence(const Message& message);
  // Compares the attached files with the sizes and CRCs in the header; throws where one differs.
  void check_files() const;

  std::ifstream in_;
  McapReader reader_;
  Header header_;
  config::Files files_;
  std::map<std::uint16_t, std::uint32_t> sequences_;  // of the next message, by channel
  McapReader::Place last_;                            // of the last message
  std::uint16_t last_channel_ = 0;
  InputMessage input_;
  TickMessage tick_;
  protocol::PartSample sample_;
  protocol::PartDescription description_;
  State state_;
  LogMessage log_;
  std::string damage_;
};

}  // namespace visum::recording
