// Writes the beginning of a recording, which is the same for all recorders: the files of the scene, the
// header, the channels, and a description of each part. Called once per file, before any other message.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/config/read_file.h"
#include "protocol/recording/loaded_scene.h"
#include "protocol/recording/mcap_writer.h"
#include "server/cycle/simulation.h"

namespace visum::recording {

// Where a world comes from. A recording needs it so that a replay can make the same world again.
struct Origin {
  config::Files files;       // every file that was read for the scene
  std::string engine;        // used in place of the scene's engine; empty: the scene's own
  std::string parameters{};  // given to the scene's file, as in scene::Options
  bool has_past = false;  // the world has left the scene's initial state: a recording begins with its state
  scene::Packages packages{};  // with those of the environment
};

// The same for a scene that took the place of the first one.
Origin origin_of(const LoadedScene& scene);

// The channels' numbers in the file.
struct Channels {
  std::uint16_t inputs = 0, ticks = 0, states = 0, log = 0;
  std::vector<std::uint16_t> parts;                  // of those that were there at the beginning
  std::uint16_t spawned = 0, spawned_described = 0;  // of all that come later
};

// Throws what the writer throws where the file cannot be written.
Channels write_beginning(McapWriter& writer, const cycle::Simulation& simulation, const Origin& origin);

}  // namespace visum::recording
