// Goes through a recording again: a fresh world, made of the files in the recording, takes the same inputs
// between the same ticks, and after each tick its hash is compared with the recorded one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "protocol/recording/records.h"
#include "server/cycle/simulation.h"
#include "server/recording/beginning.h"

namespace visum::recording {

struct PortDifference {
  std::string part, port;
  double recorded = 0.0, replayed = 0.0;
};

// Where the two worlds parted.
struct Difference {
  std::int64_t tick = 0;
  std::uint64_t era = 0;
  std::int64_t sim_time_ns = 0;
  std::uint64_t recorded_hash = 0, replayed_hash = 0;
  std::string what;                   // in words
  std::vector<PortDifference> ports;  // the first kMaxPorts of them
  static constexpr std::size_t kMaxPorts = 10;
};

struct Replay {
  Header header;
  std::uint64_t ticks = 0;   // that were equal
  std::uint64_t inputs = 0;  // that were taken
  std::uint64_t last_hash = 0;
  bool equal = true;
  Difference difference;  // where it was not
  std::string damage;     // why the file was not read to its end; empty: it was
};

// Where plug-ins of the recorded scene may come from: a recording holds files, and no code.
using PluginFolders = std::vector<std::filesystem::path>;

// What may be changed of the scene that does not belong to the world: its clock.
using Adjust = std::function<void(scene::Scene&)>;

// Throws ConfigError where the file is no recording, or the scene in it is wrong.
Replay replay(const std::filesystem::path& file, const PluginFolders& plugins = {});

// A world to go on with, and what it is made of: the files in the recording, not those on the disk today.
struct Rewound {
  std::unique_ptr<cycle::Simulation> world;
  Origin origin;
};

// The world of a recording as it was `at_s` simulated seconds after the beginning (over all eras), or at its
// end where that is sooner, which the log says: to go on from there with other inputs. Infinite: the end,
// also of what can be read of a damaged file. `adjust` may change what does not belong to the world: its
// clock. With another engine (empty: as recorded) its bodies and joints go on from where they were; what the
// recorded engines kept for themselves is dropped. Throws what replay() throws, and std::runtime_error where
// the ticks up to there differ or cannot be read.
Rewound rewind(const std::filesystem::path& file, double at_s, const Adjust& adjust,
               const PluginFolders& plugins = {}, const std::string& engine = {});

}  // namespace visum::recording
