// A recording, read front to back: first what its world was made of, then what happened in it. No record is
// given out unless its CRC is right and none of its channel is missing before it. Any one thread.
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
  // Reads up to the header. Throws config::ConfigError where there is none, or a file of the scene is
  // missing or not what the header says.
  explicit RecordingFile(const std::filesystem::path& file);

  const Header& header() const { return header_; }
  config::Files take_files() { return std::move(files_); }  // of the scene

  struct End {};
  // What comes next; valid until the next call. After the End, damage() tells whether it was the file's.
  using Item = std::variant<End, const TimedInput*, const Tick*, const protocol::PartSample*,
                            const protocol::PartDescription*, const State*>;
  Item next();

  // Where the next item stands, to come back to it.
  struct Place {
    McapReader::Place place;
    std::map<std::uint16_t, std::uint32_t> sequences;
  };
  Place place() const { return {reader_.place(), sequences_}; }
  Place place_of_last() const;  // of the item that next() has given
  void go_to(const Place& place);

  // Why nothing more was read, and where; empty: the file is whole.
  const std::string& damage() const { return damage_.empty() ? reader_.damage() : damage_; }

 private:
  Item take(const Message& message);
  template <typename Kind>
  Item take_as(Kind& kind, const Message& message);
  bool in_sequence(const Message& message);
  void check_files() const;

  std::ifstream in_;
  McapReader reader_;
  Header header_;
  config::Files files_;
  std::map<std::uint16_t, std::uint32_t> sequences_;  // the next, by channel
  McapReader::Place last_;                            // where the last message stands
  std::uint16_t last_channel_ = 0;
  InputMessage input_;
  TickMessage tick_;
  protocol::PartSample sample_;
  protocol::PartDescription description_;
  State state_;
  std::string damage_;
};

}  // namespace visum::recording
