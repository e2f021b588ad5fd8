// Reads a part's ports over a stretch of a recording, for plots. Reads the file itself, independently of the
// player. Any one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/recording/recording_file.h"

namespace visum::recording {

// A whole state in the file: how many ticks since the recording's beginning come before it, where it is, and
// how many scenes were loaded before it.
struct StatePoint {
  std::uint64_t position;
  RecordingFile::Place place;
  std::size_t loads = 0;
};

class PortReader {
 public:
  // `points`: the states of this file, sorted by position, as Player::points() has them.
  PortReader(const std::filesystem::path& file, std::vector<StatePoint> points);

  // A row for each tick in which the part was there.
  struct Rows {
    std::vector<std::uint64_t> positions;  // by row
    std::vector<double> values;  // of all rows: simulated seconds, controller inputs, sensor outputs
  };
  // Returns the last `count` ticks up to position `to`, as far back as they are of one era.
  Rows read(const std::string& part, std::uint64_t to, std::uint64_t count);

 private:
  RecordingFile file_;
  const RecordingFile::Place beginning_;
  const std::vector<StatePoint> points_;
};

}  // namespace visum::recording
