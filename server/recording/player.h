// Shows a recording: a world that can be put to any of its ticks. The file holds whole states now and then. A
// seek restores the last one before the wanted tick, or begins at the beginning, and runs the inputs from
// there.
//
// Lives on the tick's thread. This program's world may go another way than the recorded one (another build,
// another processor); then it is put right at each state of the file. Replayer is there to report
// differences.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "protocol/recording/recording_file.h"
#include "server/recording/event_list.h"
#include "server/recording/port_reader.h"
#include "server/recording/replayer.h"

namespace visum::recording {

class Player {
 public:
  // Reads the whole file once, for its length, its states and its events. Throws what replay() throws. A
  // position counts the ticks since the file's beginning, over all eras.
  Player(const std::filesystem::path& file, const PluginFolders& plugins, const Adjust& adjust = {});

  cycle::Simulation& world() { return *world_; }
  const cycle::Simulation& world() const { return *world_; }
  const Header& header() const { return file_.header(); }
  std::uint64_t ticks() const { return ticks_; }
  std::uint64_t position() const { return position_; }
  // Why the file ends at ticks(); empty: it is complete.
  const std::string& damage() const { return damage_; }

  const std::vector<StatePoint>& points() const { return points_; }
  const EventList& events() const { return events_; }

  // Makes the next recorded tick; false: the recording has ended.
  bool advance();
  // Goes to `position`, or to the end where that is sooner.
  void seek(std::uint64_t position);

  // A part's ports as recorded at this position; null: none were, and the world's ports are shown.
  const protocol::PartSample* sample(const std::string& part) const;

 private:
  // Counts the ticks, finds the states and the events; the world stands nowhere in the file afterwards.
  void read_through();
  void go_to(const StatePoint& point);
  void go_to_beginning();
  void note_scene(std::shared_ptr<const LoadedScene> scene);
  // Applies an input of the file.
  void take(const TimedInput& input);
  // Gives the world a scene of the file. Where that cannot be made here, the world stays as it is.
  void put_scene(std::size_t number);
  // Restores the state where the world differs from it.
  void put_right(const State& state);

  RecordingFile file_;
  std::vector<std::shared_ptr<const LoadedScene>> scenes_;  // the first one, and those that were loaded
  std::size_t scene_ = 0;                                   // the one at this position
  const std::unique_ptr<cycle::Simulation> world_;
  State initial_;  // the scene's
  RecordingFile::Place beginning_;
  std::vector<StatePoint> points_;  // by position
  EventList events_;
  std::map<std::string, protocol::PartSample> samples_;
  std::uint64_t ticks_ = 0, position_ = 0;
  std::string damage_;
};

}  // namespace visum::recording
