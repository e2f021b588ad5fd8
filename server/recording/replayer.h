// A recording gone through again, some ticks at a time: the inputs between the same ticks, the hash compared
// after each. Any one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "server/recording/recording_file.h"
#include "server/recording/replay.h"

namespace visum::recording {

// A fresh world as the header says, made of `files` alone.
std::unique_ptr<cycle::Simulation> make_world(const Header& header, const config::Files& files,
                                              const PluginFolders& plugins, const Adjust& adjust);

// Nothing beside the ticks: no thread paints pictures that nobody looks at.
void without_real_time(scene::Scene& scene);

class Replayer {
 public:
  // At the state that the recording begins with, if it does. Throws what replay() throws.
  Replayer(const std::filesystem::path& file, const PluginFolders& plugins,
           const Adjust& adjust = without_real_time);

  // Goes on for so many ticks at most; false: it is over, at the file's end or where it differs.
  bool run(std::uint64_t ticks);
  const Replay& result() const { return result_; }
  // The world with what it was made of, to go on without the recording.
  Rewound take_world();

 private:
  void begin();
  RecordingFile::Item next();
  void take(const RecordingFile::Item& item);
  void take(const TimedInput& input);
  void take(const State& state);
  void compare(const Tick& tick);
  void differ(const std::string& what);
  void compare_ports();
  void compare_ports(const std::string& part, const std::vector<protocol::Port>& ports,
                     const std::vector<double>& recorded, const std::vector<double>& replayed);

  RecordingFile file_;
  config::Files files_;  // the world is made of these, not of what lies on the disk today
  std::unique_ptr<cycle::Simulation> kept_;
  cycle::Simulation& world_;
  std::map<std::string, protocol::PartSample> samples_;
  Replay result_;
  std::optional<RecordingFile::Item> ahead_;  // read and not taken yet
  bool begun_ = false;                        // something was taken
  bool over_ = false;
};

}  // namespace visum::recording
