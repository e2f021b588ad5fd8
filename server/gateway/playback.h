// A recording in place of a live world, for clients that look through it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/gateway/beside.h"
#include "server/gateway/published.h"
#include "server/recording/player.h"
#include "server/recording/replayer.h"

namespace visum::gateway {

// The recording's time runs, stands and jumps; nothing else in it can be changed. A part of kind "recording"
// steers it. Its parameter Position, in ticks since the recording's beginning, jumps there. Its blackboard
// Report tells, as JSON, how far the recorded bits were compared with this program's, and the first
// difference. With a second recording, Report also tells where the two differ, and the blackboard Beside
// holds the second one's bodies (Beside::bodies()). Lives on the tick's thread, apart from ports_at(); the
// program that starts the daemon owns it.
class Playback {
 public:
  // `beside`: the second recording; empty: none. Throws what recording::Player and Beside throw.
  Playback(const std::filesystem::path& file, const recording::PluginFolders& plugins,
           const std::filesystem::path& beside = {});

  cycle::Simulation& world() { return player_.world(); }
  const std::string& name() const { return name_; }  // of the part that steers
  const std::filesystem::path& file() const { return file_; }

  // Instead of the world's own tick; false: the recording ends here.
  bool tick() { return player_.advance(); }
  // Compares one more tick with that of the second recording; then one more with the recorded one, in a world
  // of its own. False: all ticks have been compared.
  bool compare();
  // The era that clients are shown: each jump begins a new one.
  std::uint64_t era();
  // The sessions' thread: rows of PortReader's, as bytes of little-endian doubles, for the path
  // /recording/ports/PART/TO/COUNT: a part by its number, a position, and how many ticks up to it; for
  // /recording/beside/ports/..., the second recording's (Beside::ports()). Nothing where the path names no
  // part or position.
  std::optional<std::string> ports_at(const std::string& path);
  // The events of the recording as JSON, for the path /recording/events. Any thread.
  const std::string& events() const { return events_; }
  // Puts what was recorded in place of what the world's parts show, and the jumps into its era.
  void show(Published& published);

 private:
  class Steering;

  void seek(std::uint64_t position);
  std::string report() const;
  void show_ports(Published& published) const;

  const std::filesystem::path file_;
  const std::unique_ptr<Beside> beside_;  // null: there is no second recording
  recording::Player player_;
  recording::Replayer comparison_;
  recording::PortReader ports_;
  std::vector<protocol::PartDescription> parts_;  // by number
  const std::string events_;
  std::string name_;
  std::uint64_t jumps_ = 0;
  std::uint64_t recorded_era_ = 1;  // of the last look
  std::uint64_t shown_era_ = 1;
  std::uint64_t shown_revision_ = 1;
  std::shared_ptr<const WorldView> view_;  // filled once bodies came or went; null: as at the beginning
};

}  // namespace visum::gateway
