// A recording to look at: a world that can be put to any of its ticks. A seek restores the whole state that
// the file holds before that tick and runs the inputs up to it; where the file holds none, from its
// beginning. Where this program's world goes another way than the recorded one, it is put right at each such
// state. Lives on the tick's thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/recording/port_reader.h"
#include "server/recording/recording_file.h"
#include "server/recording/replayer.h"

namespace visum::recording {

class Player {
 public:
  // Reads the file through once, for its length and its states; throws what replay() throws. A place in it is
  // a position: ticks since its beginning, over all eras.
  Player(const std::filesystem::path& file, const PluginFolders& plugins, const Adjust& adjust = {});

  cycle::Simulation& world() { return *world_; }
  const cycle::Simulation& world() const { return *world_; }
  const Header& header() const { return file_.header(); }
  std::uint64_t ticks() const { return ticks_; }
  std::uint64_t position() const { return position_; }
  // Why the file ends there; empty: it is whole.
  const std::string& damage() const { return damage_; }

  const std::vector<StatePoint>& points() const { return points_; }

  // The next recorded tick; false: there is none.
  bool advance();
  // To `position`, or the end where that is sooner.
  void seek(std::uint64_t position);

  // A part's ports as they were recorded at this position; null: as the world's.
  const protocol::PartSample* sample(const std::string& part) const;

 private:
  void read_through();
  void go_to(const StatePoint& point);
  void go_to_beginning();
  void put_right(const State& state);

  RecordingFile file_;
  const config::Files files_;
  const std::unique_ptr<cycle::Simulation> world_;
  State initial_;  // of the scene
  RecordingFile::Place beginning_;
  std::vector<StatePoint> points_;  // by position
  std::map<std::string, protocol::PartSample> samples_;
  std::uint64_t ticks_ = 0, position_ = 0;
  std::string damage_;
};

}  // namespace visum::recording
