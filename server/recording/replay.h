// Replays a recording: a fresh world, made of the files in the recording, takes the same inputs between the
// same ticks. After each tick its hash is compared with the recorded one, or its ports where no hash was
// recorded (records.h). Any one thread.
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

// Where the replayed world first differs from the recorded one.
struct Difference {
  std::int64_t tick = 0;
  std::uint64_t era = 0;
  std::int64_t sim_time_ns = 0;
  std::uint64_t recorded_hash = kNoHash, replayed_hash = kNoHash;
  std::string what;                   // says in words what differs
  std::vector<PortDifference> ports;  // the ports that differ, kMaxPorts at most
  static constexpr std::size_t kMaxPorts = 10;
};

struct Replay {
  Header header;
  std::uint64_t ticks = 0;          // how many were equal
  std::uint64_t ticks_to_hash = 0;  // how many up to the last hash; those after it are equal in their ports
  std::uint64_t inputs = 0;         // how many were taken
  std::uint64_t last_hash = 0;      // of the replayed world's state after its last tick
  bool equal = true;
  Difference difference;  // where !equal
  std::string damage;     // why the file was not read to its end; empty: it was
};

// The folders where plug-ins of the recorded scene are looked for: a recording holds no code.
using PluginFolders = std::vector<std::filesystem::path>;

// Changes those settings of the scene that do not belong to the world, such as its clock.
using Adjust = std::function<void(scene::Scene&)>;

// Throws ConfigError where the file is no recording, or where the scene in it is wrong.
Replay replay(const std::filesystem::path& file, const PluginFolders& plugins = {});

// A world to go on with, and the files that it is made of: those in the recording, not those on the disk
// today.
struct Rewound {
  std::unique_ptr<cycle::Simulation> world;
  Origin origin;
};

// Makes the world of a recording as it was `at_s` simulated seconds after the beginning, over all eras, to go
// on from there with other inputs. A recording that ends sooner gives its end, and the log says so. Infinite
// means the end, also the readable end of a damaged file.
//
// `engine` replaces the recorded engines (empty: it does not). Bodies and joints then go on from where they
// were, but what the recorded engines kept for themselves is dropped.
//
// Throws what replay() throws, and std::runtime_error where the ticks up to there differ or cannot be read.
Rewound rewind(const std::filesystem::path& file, double at_s, const Adjust& adjust,
               const PluginFolders& plugins = {}, const std::string& engine = {});

}  // namespace visum::recording
