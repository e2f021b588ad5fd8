// Replays a recording some ticks at a time, so that a server can do it while it has nothing else to do. Any
// one thread. A difference or a damaged file ends the replay; result() says where and why.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "protocol/recording/recording_file.h"
#include "server/recording/replay.h"

namespace visum::recording {

// Makes a fresh world as the header says, from `files` alone: the disk is not read.
std::unique_ptr<cycle::Simulation> make_world(const Header& header, const config::Files& files,
                                              const PluginFolders& plugins, const Adjust& adjust);

// The header that a recording of this scene alone would have, as far as make_world() needs it; and the scene
// that a header describes.
Header header_of(Header of_first, const LoadedScene& scene);
LoadedScene scene_of(const Header& header, config::Files files);

// Sets the clock to free, so that cameras start no thread for pictures that nobody looks at.
void without_real_time(scene::Scene& scene);

class Replayer {
 public:
  // Restores the state that the recording begins with, if there is one. Throws what replay() throws.
  Replayer(const std::filesystem::path& file, const PluginFolders& plugins,
           const Adjust& adjust = without_real_time);

  // Replays at most so many ticks; false: the replay is over, at the file's end or at the first difference.
  bool run(std::uint64_t ticks);
  const Replay& result() const { return result_; }
  // Describes the scene that the world has now: result().header, unless another one was loaded.
  const Header& header() const { return header_; }
  // Gives the world away, to go on without the recording. The replayer must not be used afterwards.
  Rewound take_world();

 private:
  // Restores the first state, if the recording begins with one.
  void begin();
  RecordingFile::Item next();
  void take(const RecordingFile::Item& item);
  void take(const TimedInput& input);
  void take(const State& state);
  // Makes a tick and compares it with the recorded one.
  void compare(const Tick& tick);
  // Ends the replay; result() then says `what` and where the world stands.
  void differ(const std::string& what, std::uint64_t recorded_hash = kNoHash);
  void note_last_hash();
  // Notes the ports that differ, for the user. Returns the name of a part whose ports the recording has not,
  // or not all; empty: there is none.
  std::string compare_ports();
  void compare_ports(const std::string& part, const std::vector<protocol::Port>& ports,
                     const std::vector<double>& recorded, const std::vector<double>& replayed);

  RecordingFile file_;
  Header header_;        // of the scene that the world has now
  config::Files files_;  // of that scene; bodies that come later may read them, too
  std::unique_ptr<cycle::Simulation> kept_;
  cycle::Simulation& world_;
  std::map<std::string, protocol::PartSample> samples_;
  Replay result_;
  std::optional<RecordingFile::Item> ahead_;  // read but not yet taken
  bool begun_ = false;                        // the first record was taken
  bool over_ = false;
  bool hash_is_noted_ = false;  // that of the last tick, or of the beginning
};

}  // namespace visum::recording
