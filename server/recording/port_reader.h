// A part's ports over a stretch of a recording, for plots. Any one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/recording/recording_file.h"

namespace visum::recording {

// Where the whole state stands after so many ticks since the recording's beginning.
struct StatePoint {
  std::uint64_t position;
  RecordingFile::Place place;
};

class PortReader {
 public:
  // `points`: of this file, by position.
  PortReader(const std::filesystem::path& file, std::vector<StatePoint> points);

  // A row for each of the last `count` ticks up to position `to` that are of one era: simulated seconds,
  // controller inputs, sensor outputs.
  std::vector<double> read(const std::string& part, std::uint64_t to, std::uint64_t count);

 private:
  RecordingFile file_;
  const RecordingFile::Place beginning_;
  const std::vector<StatePoint> points_;
};

}  // namespace visum::recording
