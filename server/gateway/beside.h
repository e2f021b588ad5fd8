// A second recording beside the one that a Playback shows: B beside A. Both stand at the same number of ticks
// since their beginning; where B is over, it stands at its end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "protocol/part_description.h"
#include "protocol/recording/recording_pair.h"
#include "server/recording/player.h"

namespace visum::gateway {

// Compares the two as `visum compare` does, and shows where B's bodies are. Lives on the tick's thread, apart
// from ports().
class Beside {
 public:
  // Throws what recording::Player and recording::RecordingPair throw.
  Beside(const std::filesystem::path& a, const std::filesystem::path& b,
         const recording::PluginFolders& plugins);

  // Compares one more tick of the two. False: both have ended, or one is damaged.
  bool compare();
  // Tells as JSON what was found so far.
  std::string report() const;

  // Where B's bodies are when A is this world at this position: the position, A's simulated seconds, then
  // for each body of A B's pose (x y z qw qx qy qz; m, world frame) and how far it is from A's (m, rad). All
  // NaN where B has no body of this name. Valid until the next call.
  std::span<const double> bodies(const cycle::Simulation& a, std::uint64_t position);

  // The sessions' thread: B's ports as rows of A's. `a` are rows of A's part, described by `part`. Each row
  // is A's simulated seconds, then B's inputs and outputs in the order of A's, with NaN for a port that B
  // does not have. Ticks that B does not have are left out.
  std::vector<double> ports(const protocol::PartDescription& part, const recording::PortReader::Rows& a,
                            std::uint64_t to, std::uint64_t count);

 private:
  std::string ports_as_json() const;

  const std::string file_name_;
  recording::RecordingPair pair_;
  recording::Player player_;
  recording::PortReader ports_;
  std::map<std::string, std::map<std::string, std::size_t>> columns_;  // of B's rows, by part and port
  std::vector<double> bodies_;
  bool over_ = false;
  std::string damage_;  // empty: none so far
};

}  // namespace visum::gateway
