// The files that a daemon keeps for its clients: snapshots with names, and recordings that were started while
// the world ran. Clients give names, never paths.
//
// A snapshot is a recording of no ticks: the files of the scene and one whole state. So `visum rewind` goes
// on from it, too.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/cycle/simulation.h"
#include "server/recording/beginning.h"
#include "server/recording/recorder.h"

namespace visum::recording {

// Made and owned by the program; any one thread at a time. The functions throw std::runtime_error with a text
// for the client.
class Archive {
 public:
  static constexpr std::size_t kMostSnapshots = 256;  // files

  Archive(std::filesystem::path folder, Origin origin)
      : folder_(std::move(folder)), origin_(std::move(origin)) {}
  // From now on the world is one of another scene. `origin` becomes the one before.
  void swap_origin(Origin& origin) { std::swap(origin_, origin); }

  // Replaces an older snapshot of that name. `state` is of this world, without the snapshots that it keeps.
  void save(const cycle::Simulation& simulation, const std::string& name, const State& state) const;
  // Refuses a snapshot of another scene, seed, tick or build, and a damaged file.
  State load(const cycle::Simulation& simulation, const std::string& name) const;
  // A recorder that is to begin. Refuses a name that is there already.
  std::unique_ptr<Recorder> record(cycle::Simulation& simulation, const std::string& name) const;

  std::filesystem::path snapshot_file(const std::string& name) const {
    return folder_ / (name + ".snapshot.mcap");
  }
  std::filesystem::path recording_file(const std::string& name) const { return folder_ / (name + ".mcap"); }

 private:
  void make_folder() const;
  std::filesystem::path folder_;
  Origin origin_;
};

}  // namespace visum::recording
